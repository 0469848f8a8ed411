#include "core/scene/pixel_samples.h"

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "core/math/mixed_bits.h"

namespace linetree {
namespace {

// Coprime to `count` and nearest to `count` by the golden ratio; the smaller of two.
int LatticeStep(int count) {
  const double wanted = count / std::numbers::phi;
  int best = 1;
  for (int step = 1; step < count; ++step) {
    if (std::gcd(step, count) == 1 && std::abs(step - wanted) < std::abs(best - wanted)) {
      best = step;
    }
  }
  return best;
}

}  // namespace

absl::Status ValidateSampling(const Sampling& sampling) {
  if (sampling.samples >= 1 && sampling.samples <= kMaxPixelSamples) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("sampling.samples: expected 1 to ",
                                                 kMaxPixelSamples, ", got ", sampling.samples));
}

PixelSamples::PixelSamples(const Sampling& sampling)
    : jittered_(sampling.pattern == SamplePattern::kJittered), seed_(MixedBits(sampling.seed)) {
  const int count = sampling.samples;
  across_ = static_cast<int>(std::lround(std::sqrt(count)));
  down_ = across_;
  if (across_ * down_ == count) return;
  across_ = count;
  down_ = 1;
  const int step = LatticeStep(count);
  for (int i = 0; i < count; ++i) {
    height_[static_cast<size_t>(i)] = static_cast<uint8_t>(step * i % count);
  }
}

PixelSamples::Place PixelSamples::PlaceIn(int column, int row) const {
  Place place;
  if (jittered_) {
    const auto pixel = static_cast<uint64_t>(row / down_) << 32 |
                       static_cast<uint64_t>(static_cast<uint32_t>(column / across_));
    const auto sample = static_cast<uint64_t>(row % down_ * across_ + column % across_);
    const uint64_t bits = MixedBits(MixedBits(seed_ ^ pixel) + sample);
    place = {static_cast<double>(bits >> 32) * 0x1p-32,
             static_cast<double>(bits & 0xffffffffu) * 0x1p-32};
  }
  if (across_ != down_) {
    place.y = (height_[static_cast<size_t>(column % across_)] + place.y) / across_;
  }
  return place;
}

double PixelSamples::MeanOff() const { return jittered_ ? 1.0 / across_ : 0; }

}  // namespace linetree
