// Affine maps of the scene file: how a shape's own coordinates become world coordinates.
#pragma once

#include "absl/status/statusor.h"
#include "core/math/vec3.h"

namespace linetree {

// p -> linear * p + translation. The default is the identity.
struct AffineMap {
  Mat3 linear;
  Vec3d translation;
  bool operator==(const AffineMap&) const = default;
};

Vec3d Apply(const AffineMap& map, const Vec3d& point);

// First `first`, then `second`.
AffineMap Then(const AffineMap& first, const AffineMap& second);

AffineMap Translation(const Vec3d& offset);
AffineMap Scaling(const Vec3d& factors);
// Right-handed turn about an axis through the origin; the axis is not zero.
AffineMap Rotation(const Vec3d& axis, double angle_deg);

Mat3 Product(const Mat3& a, const Mat3& b);
Mat3 Transposed(const Mat3& m);

// A map whose largest and smallest stretch differ by more than 1 / kMinReciprocalCondition is
// refused as not invertible: its inverse would keep fewer than 12 of the 52 bits.
inline constexpr double kMinReciprocalCondition = 0x1p-40;

// The inverse of the linear part, or INVALID_ARGUMENT ("transform: expected ...").
absl::StatusOr<Mat3> InverseLinear(const AffineMap& map);

// The result's product with the linear part differs from the identity, in the Frobenius norm, by at
// most this times the product of the two's norms: each entry is a quotient of a sum of products and
// a determinant, some 12 roundings of 2^-53, doubled and rounded up.
inline constexpr double kInverseRounding = 0x1p-48;

// Rounding of every entry of Rotation, times 1 + the angle in radians: the angle's two roundings,
// the three of a sum of products of sine, cosine and the axis, whose own are 6; rounded up.
inline constexpr double kRotationRounding = 0x1p-49;

// v / |v| without overflow or underflow on the way. Requires v finite and non-zero. Components are
// within kNormalizedRounding and one more rounding of 2^-53, relative (but for denormal ones).
Vec3d Unit(const Vec3d& v);

}  // namespace linetree
