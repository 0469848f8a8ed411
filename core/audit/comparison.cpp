#include "core/audit/comparison.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace linetree {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

bool SameBits(double a, double b) {
  return std::bit_cast<uint64_t>(a) == std::bit_cast<uint64_t>(b);
}

double AsFloat(double value) { return static_cast<double>(static_cast<float>(value)); }

// Error beyond `rounding` over what is allowed.
double Ratio(double answer, double classical, double rounding, double epsilon, double floor) {
  const double allowed = epsilon * std::max(classical, floor);
  const double error = std::max(std::abs(answer - classical) - rounding, 0.0);
  const double ratio = error / allowed;
  return ratio >= 0 ? ratio : kInf;  // 0 / 0 and what is not a number
}

double RatioRounded(double answer, double classical, double epsilon, double floor) {
  constexpr double kLargestFloat = std::numeric_limits<float>::max();
  if (std::isinf(answer)) {  // too large for a float; the promise may allow for that
    return classical + epsilon * classical > kLargestFloat ? 0 : kInf;
  }
  const double rounding = kFloatRounding * std::abs(answer) + kSmallestFloatRounding;
  return Ratio(answer, classical, rounding, epsilon, floor);
}

template <class Same, class ChannelRatio>
Comparison CompareChannels(const Rgb& answer, const Rgb& classical, const Same& same,
                           const ChannelRatio& ratio) {
  Comparison result;
  for (int c = 0; c < 3; ++c) {
    if (same(answer[c], classical[c])) continue;
    result.equal = false;
    result.error_over_allowed = std::max(result.error_over_allowed, ratio(answer[c], classical[c]));
  }
  return result;
}

}  // namespace

Comparison Compare(const Rgb& answer, const Rgb& classical, double epsilon, double floor) {
  return CompareChannels(answer, classical, SameBits, [&](double a, double c) {
    return epsilon == 0 ? kInf : Ratio(a, c, 0, epsilon, floor);
  });
}

Comparison CompareRounded(const Rgb& answer, const Rgb& classical, double epsilon, double floor,
                          double lane_rounding) {
  const double allowed = epsilon + lane_rounding;
  const auto same = [](double a, double c) { return SameBits(a, AsFloat(c)); };
  return CompareChannels(answer, classical, same, [&](double a, double c) {
    return allowed == 0 ? kInf : RatioRounded(a, c, allowed, floor);
  });
}

}  // namespace linetree
