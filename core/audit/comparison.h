// Whether an answer keeps the promise |answer - classical| <= epsilon * max(classical, floor).
#pragma once

#include "core/math/rgb.h"

namespace linetree {

// Frames hold floats. Rounding to the nearest float moves a radiance by at most this share of the
// float (half of its last place, 2^-24), or by half of the smallest subnormal float.
inline constexpr double kFloatRounding = 0x1p-24;
inline constexpr double kSmallestFloatRounding = 0x1p-150;

struct Comparison {
  bool equal = true;  // bit for bit, all channels
  // Of the worst channel. 0 when equal; infinity when epsilon is 0 and they differ, and for what is
  // not a number.
  double error_over_allowed = 0;

  bool IsViolation() const { return error_over_allowed > 1; }
};

// `floor` is RadianceFloor of the scene.
Comparison Compare(const Rgb& answer, const Rgb& classical, double epsilon, double floor);

// The same for an answer that was rounded to float, given as the doubles of those floats; equal
// means equal to the rounded classical radiance. What arithmetic in float may add to epsilon is
// allowed too (Frame::lane_rounding).
Comparison CompareRounded(const Rgb& answer, const Rgb& classical, double epsilon, double floor,
                          double lane_rounding = 0);

}  // namespace linetree
