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

// v / |v| without overflow or underflow on the way. Requires v finite and non-zero.
Vec3d Unit(const Vec3d& v);

}  // namespace linetree
