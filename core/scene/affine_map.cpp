#include "core/scene/affine_map.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

#include "core/math/check.h"

namespace linetree {
namespace {

// GLM stores columns, Mat3 rows.
glm::dmat3 ToGlm(const Mat3& m) {
  const auto& r = m.row;
  return {r[0].x, r[1].x, r[2].x, r[0].y, r[1].y, r[2].y, r[0].z, r[1].z, r[2].z};
}

Mat3 FromGlm(const glm::dmat3& m) {
  return {{Vec3d{m[0][0], m[1][0], m[2][0]}, Vec3d{m[0][1], m[1][1], m[2][1]},
           Vec3d{m[0][2], m[1][2], m[2][2]}}};
}

double MaxAbs(const Vec3d& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

double MaxAbs(const Mat3& m) {
  return std::max({MaxAbs(m.row[0]), MaxAbs(m.row[1]), MaxAbs(m.row[2])});
}

bool IsFinite(const Mat3& m) {
  return linetree::IsFinite(m.row[0]) && linetree::IsFinite(m.row[1]) &&
         linetree::IsFinite(m.row[2]);
}

double FrobeniusNorm(const Mat3& m) {
  return std::sqrt(LengthSquared(m.row[0]) + LengthSquared(m.row[1]) + LengthSquared(m.row[2]));
}

Mat3 Scaled(const Mat3& m, double k) { return {{m.row[0] * k, m.row[1] * k, m.row[2] * k}}; }

}  // namespace

Vec3d Apply(const AffineMap& map, const Vec3d& point) {
  return map.linear * point + map.translation;
}

Mat3 Product(const Mat3& a, const Mat3& b) { return FromGlm(ToGlm(a) * ToGlm(b)); }

Mat3 Transposed(const Mat3& m) { return FromGlm(glm::transpose(ToGlm(m))); }

AffineMap Then(const AffineMap& first, const AffineMap& second) {
  return {Product(second.linear, first.linear), Apply(second, first.translation)};
}

AffineMap Translation(const Vec3d& offset) { return {Mat3{}, offset}; }

AffineMap Scaling(const Vec3d& factors) {
  return {{{Vec3d{factors.x, 0, 0}, Vec3d{0, factors.y, 0}, Vec3d{0, 0, factors.z}}}, Vec3d{}};
}

AffineMap Rotation(const Vec3d& axis, double angle_deg) {
  const Vec3d u = Unit(axis);
  const glm::dmat4 turn =
      glm::rotate(glm::dmat4(1), glm::radians(angle_deg), glm::dvec3(u.x, u.y, u.z));
  return {FromGlm(glm::dmat3(turn)), Vec3d{}};
}

absl::StatusOr<Mat3> InverseLinear(const AffineMap& map) {
  if (!IsFinite(map.linear) || !linetree::IsFinite(map.translation)) {
    return absl::InvalidArgumentError("transform: expected a finite map");
  }
  // Scaled to entries of at most 1, so that the determinant neither overflows nor underflows.
  const double size = MaxAbs(map.linear);
  if (size > 0) {
    const Mat3 unit = Scaled(map.linear, 1 / size);
    const Mat3 inverse = FromGlm(glm::inverse(ToGlm(unit)));
    const bool usable = IsFinite(inverse) &&
                        FrobeniusNorm(unit) * FrobeniusNorm(inverse) * kMinReciprocalCondition < 1;
    const Mat3 result = Scaled(inverse, 1 / size);
    if (usable && IsFinite(result)) return result;
  }
  return absl::InvalidArgumentError(
      "transform: expected an invertible map, got one that flattens space");
}

Vec3d Unit(const Vec3d& v) {
  const double size = MaxAbs(v);
  LT_CHECK(size > 0 && std::isfinite(size));
  // Dividing, because 1 / size overflows for the smallest numbers.
  return Normalized(Vec3d{v.x / size, v.y / size, v.z / size});
}

}  // namespace linetree
