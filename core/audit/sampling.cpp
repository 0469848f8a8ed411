#include "core/audit/sampling.h"

#include <cmath>

#include "core/audit/random_stream.h"

namespace linetree {

SampledIndices::SampledIndices(double share, uint64_t request)
    : share_(share), state_(MixBits(request + 1)) {}

uint64_t SampledIndices::Next() {
  if (!(share_ > 0) || next_ == kNone) return kNone;
  if (share_ >= 1) return next_++;
  // The number skipped before a success of probability p is at least k with probability (1-p)^k.
  RandomStream random(state_);
  state_ = random.Bits();
  const double skipped = std::floor(std::log1p(-random.Unit()) / std::log1p(-share_));
  // Also where the sum would not fit any more.
  if (!(skipped < 0x1p62)) return next_ = kNone;
  const uint64_t index = next_ + static_cast<uint64_t>(skipped);
  next_ = index + 1;
  return index;
}

}  // namespace linetree
