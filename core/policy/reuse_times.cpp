#include "core/policy/reuse_times.h"

namespace linetree {

uint32_t ReuseTimes::FirstAge(size_t bin) {
  if (bin < kExactAges) return static_cast<uint32_t>(bin + 1);
  const size_t octave = 4 + (bin - kExactAges) / 4;
  return static_cast<uint32_t>((4 + (bin - kExactAges) % 4) << (octave - 2));
}

// hazard: the chance that a spell ends within a bin that it has reached; `wait`: frames until it
// enters the first one.
double ReuseTimes::Index(const Bins& hazard, size_t from, double wait) {
  double alive = 1, time = wait, best = 0;
  for (size_t bin = from; bin < kAges; ++bin) {
    const double width = FirstAge(bin + 1) - FirstAge(bin);
    // Who ends within a bin does so in its middle.
    time += alive * width * (1 - hazard[bin] / 2);
    alive *= 1 - hazard[bin];
    best = std::max(best, (1 - alive) / time);
  }
  return best;
}

void ReuseTimes::Learn() {
  Bins all_ended{}, all_reached{};
  std::vector<Bins> reached(ended_.size());
  for (size_t kind = 0; kind < ended_.size(); ++kind) {
    double sum = 0;
    for (size_t bin = kAges; bin-- > 0;) {
      // Who is open in a bin has been there for half of it, on average.
      reached[kind][bin] = sum + ended_[kind][bin] + open_[kind][bin] / 2;
      sum += ended_[kind][bin] + open_[kind][bin];
      all_ended[bin] += ended_[kind][bin];
      all_reached[bin] += reached[kind][bin];
    }
  }
  double seen = 0;
  for (size_t bin = 0; bin < kAges; ++bin) {
    seen += all_ended[bin];
    usual_gap_ = FirstAge(bin + 1) - 1;
    if (seen >= 0.9 * ended_count_) break;
  }
  for (size_t kind = 0; kind < ended_.size(); ++kind) {
    Bins hazard{};
    for (size_t bin = 0; bin < kAges; ++bin) {
      const double usual = (all_ended[bin] + 0.01) / (all_reached[bin] + 1);
      hazard[bin] =
          std::min(1.0, (ended_[kind][bin] + kLeanOn * usual) / (reached[kind][bin] + kLeanOn));
    }
    for (size_t bin = 0; bin < kAges; ++bin) worth_[kind][bin] = Index(hazard, bin, 0);
    fresh_[kind] = Index(hazard, 0, 1);
  }
}

}  // namespace linetree
