// What rounding may do to the search in float, u = 2^-24.
//
// For one packet and one shape let R be the largest |o| of its rays, plus the reach of the shape
// (both from the scene's reference point), plus least_length(). Where a ray is within the reach of
// the shape, its parameter t is at most R.
#pragma once

#include <cstdint>

namespace linetree {

inline constexpr float kFloatUnit = 0x1p-24f;

// A line in float, carried into the frame of a shape (times the norm of the map), is nowhere
// within the reach of the shape farther than kLineMargin * R from the line in double: u for the
// origin, u for the shape's centre, 10 u for the direction (towards a light: 2 u for each
// component, 8 u for its length) times t <= R, u for their difference, 3 u for the map, 6 u for a
// dot product and the step along the line to its nearest point: 24 u, rounded up to 32. The
// parameter of that nearest point is as certain, in units of the direction's length.
inline constexpr float kLineMargin = 32 * kFloatUnit;

// Ball: with w the distance from the centre, within m = kLineMargin * R of its true value,
// r^2 - w^2 is off by 2 w m + m^2 and its own rounding. Where that exceeds r m kBallByRadius +
// m^2 kBallBySquare, with w = r + x, x (2 r + x) > 3 r m + 12 m^2, which is more than
// 2 (r + x) m + m^2 for every r; x from the other side is smaller.
inline constexpr float kBallByRadius = 3, kBallBySquare = 12;

// Planes of a box: t = (plane - o) / d is off by less than kSlabMargin * R / |d|: 3 u for the
// origin and its product with 1 / d, 2 u for the plane, 10 u for d, 3 u for the reciprocal and the
// sum, of R / |d| each; and by the map as above (kLineMargin), with which the slope itself is off
// by less than a tenth of kLineMargin. Doubled.
inline constexpr float kSlabMargin = 96 * kFloatUnit;

// A plane met at t: distance and slope are off by 8 u R and 16 u, t by
// kPlaneMargin * (R + |t|) / |slope|, and the point in the plane by as much in every coordinate.
// Coefficients of the projected edges are at most 1.5 each, their sum 3; their own rounding is 6 u.
inline constexpr float kPlaneMargin = 32 * kFloatUnit;
inline constexpr float kEdgeMargin = 4 * kPlaneMargin;

// Frustum, in object space where it is within 1.5 of the base's centre, with m the line's margin
// times the map's norm (no less than 32 u), for the shape and for its lines of unit direction: 1.5
// of what kLineMargin says, for the step to the nearest point and the length of the direction.
inline constexpr float kFrustumLine = 1.5f;
// The lateral form x^2 + y^2 - w^2 has a gradient of at most 2 |x, y| + 2 w |taper|. The square of
// the half chord is a sum of squares of x slope - w q.x, the same for y, and x q.y - y q.x; the
// last is below 1.5 and off by m, the first two are below 1 for a cylinder, where only q is off,
// and below 2.5 for a cone, where they are off by 2 |taper| m: all in all 5 m + 15 |taper| m, and
// the form itself less. With 24 u of rounding each:
inline constexpr float kLateralForm = 8, kLateralTaper = 24;
// With s the root of the half chord's square a crossing is off by what the form is off by over 2 s,
// provided that the direction leaves the generators by at least kLeastLateral (its square's
// coefficient), and by its own rounding, which kLeastLateral magnifies to 12 * 64 u / s = 24 m / s.
inline constexpr float kLateralRoot = 32;
inline constexpr float kLeastLateral = 0x1p-6f;

// A cosine in double of a light that is at least this much above or below the horizon has the sign
// that the scalar tracer finds: some ten roundings of 2^-53 lie between them.
inline constexpr float kSureCosine = 0x1p-40f;

// Boxes: a packet's bounds are widened by kShaftPad times (lengths as in R), and comparisons of
// distances relaxed by this factor: 4 u for an interval's ends and 4 u for the quotients; the rest
// is for sums of lengths that are themselves rounded.
inline constexpr float kShaftPad = 64 * kFloatUnit;
inline constexpr float kShaftSlack = 1 + 32 * kFloatUnit;

// A coordinate of a direction that is smaller than this (and zero) counts as this: along it the
// line moves by less than R * 2^-60.
inline constexpr float kLeastSlope = 0x1p-60f;

}  // namespace linetree
