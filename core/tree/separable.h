// Strict linear separability of two sets of directions (paper section 5.3): the test for peaks.
#pragma once

#include <span>

#include "core/math/vec3.h"

namespace linetree {

// Whether some D has D.a < 0 for every a in `a` and D.b > 0 for every b in `b`, by margins of
// kSeparationMargin of the vectors' lengths. Vectors must be finite and non-zero; either set may be
// empty. A program in two variables after fixing D.m = 1 for the mean direction m (Seidel's
// incremental algorithm, order of insertion fixed): linear time for sets that agree, quadratic at
// worst.
bool StrictlySeparable(std::span<const Vec3d> a, std::span<const Vec3d> b);

// Sine of the smallest angle by which a separating plane must clear every direction: far above the
// rounding of unit vectors (2^-52), far below any angle that a picture resolves.
inline constexpr double kSeparationMargin = 1e-9;

}  // namespace linetree
