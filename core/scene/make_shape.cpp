#include "core/scene/make_shape.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"

namespace linetree {
namespace {

std::string Text(const Vec3d& v) { return absl::StrCat("(", v.x, ", ", v.y, ", ", v.z, ")"); }

Mat3 FromColumns(const Vec3d& x, const Vec3d& y, const Vec3d& z) { return Transposed({{x, y, z}}); }

bool IsModerate(const Vec3d& v) {
  // Written so that NaN fails.
  return std::abs(v.x) <= kMaxMagnitude && std::abs(v.y) <= kMaxMagnitude &&
         std::abs(v.z) <= kMaxMagnitude;
}
bool IsModerate(const Mat3& m) {
  return IsModerate(m.row[0]) && IsModerate(m.row[1]) && IsModerate(m.row[2]);
}

// A shape's canonical frame in its own coordinates: orthogonal axes times lengths.
struct OwnFrame {
  Vec3d center;
  std::array<Vec3d, 3> axes;  // unit, orthogonal
  Vec3d lengths;
};

// The inverse is composed from the inverses of the factors: flat shapes (a disc, a needle of an
// ellipsoid) lose nothing by it.
absl::StatusOr<AffineFrame> Compose(const OwnFrame& own, const AffineMap& map) {
  auto inverse = InverseLinear(map);
  if (!inverse.ok()) return inverse.status();
  const auto& [x, y, z] = own.axes;
  const Vec3d& l = own.lengths;
  AffineFrame frame;
  frame.center = Apply(map, own.center);
  frame.world_from_object = Product(map.linear, FromColumns(x * l.x, y * l.y, z * l.z));
  frame.object_from_world = Product({{x * (1 / l.x), y * (1 / l.y), z * (1 / l.z)}}, *inverse);
  if (!IsModerate(frame.center) || !IsModerate(frame.world_from_object) ||
      !IsModerate(frame.object_from_world)) {
    return absl::InvalidArgumentError(
        absl::StrCat("transform: expected a map that keeps coordinates and lengths within ",
                     kMaxMagnitude, " and its reciprocal"));
  }
  return frame;
}

constexpr std::array<Vec3d, 3> kWorldAxes{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};

// A right-handed orthonormal basis whose third vector is the unit vector z.
std::array<Vec3d, 3> BasisAbout(const Vec3d& z) {
  // The world axis that is farthest from z, so that the cross product is at least sqrt(2/3) long.
  const Vec3d a{std::abs(z.x), std::abs(z.y), std::abs(z.z)};
  const size_t k = a.x <= a.y && a.x <= a.z ? 0 : a.y <= a.z ? 1 : 2;
  const Vec3d x = Normalized(Cross(kWorldAxes[k], z));
  return {x, Cross(z, x), z};
}

absl::Status CheckRadii(const FrustumParameters& p) {
  const double larger = std::max(p.base_radius, p.top_radius);
  for (const auto& [field, radius] :
       {std::pair("base_radius", p.base_radius), std::pair("top_radius", p.top_radius)}) {
    if (radius == 0 && larger > 0) continue;
    if (auto s = CheckLength(field, radius); !s.ok()) return s;
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status CheckPoint(const std::string& field, const Vec3d& point) {
  if (IsModerate(point)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(field, ": expected finite coordinates of magnitude <= ", kMaxMagnitude, ", got ",
                   Text(point)));
}

absl::Status CheckLength(const std::string& field, double length) {
  if (!std::isfinite(length) || !(length > 0)) {
    return absl::InvalidArgumentError(
        absl::StrCat(field, ": expected a finite number > 0, got ", length));
  }
  if (length > kMaxMagnitude || length < 1 / kMaxMagnitude) {
    return absl::InvalidArgumentError(absl::StrCat(field, ": expected a number in [",
                                                   1 / kMaxMagnitude, ", ", kMaxMagnitude,
                                                   "], got ", length));
  }
  return absl::OkStatus();
}

absl::Status CheckDirection(const std::string& field, const Vec3d& direction) {
  if (IsFinite(direction) && direction != Vec3d{}) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(field, ": expected a finite, non-zero vector, got ", Text(direction)));
}

absl::StatusOr<Shape> MakeSphere(const Vec3d& center, double radius, const AffineMap& map) {
  if (auto s = CheckPoint("center", center); !s.ok()) return s;
  if (auto s = CheckLength("radius", radius); !s.ok()) return s;
  auto frame = Compose({center, kWorldAxes, {radius, radius, radius}}, map);
  if (!frame.ok()) return frame.status();
  return SphereShape{*frame};
}

absl::StatusOr<Shape> MakeEllipsoid(const Vec3d& center, const Vec3d& semi_axes,
                                    const AffineMap& map) {
  if (auto s = CheckPoint("center", center); !s.ok()) return s;
  for (int i = 0; i < 3; ++i) {
    const std::string field = absl::StrCat("semi_axes.", std::string(1, "xyz"[i]));
    if (auto s = CheckLength(field, semi_axes[i]); !s.ok()) return s;
  }
  auto frame = Compose({center, kWorldAxes, semi_axes}, map);
  if (!frame.ok()) return frame.status();
  return SphereShape{*frame};
}

absl::StatusOr<Shape> MakeBox(const Vec3d& min, const Vec3d& max, const AffineMap& map) {
  if (auto s = CheckPoint("min", min); !s.ok()) return s;
  if (auto s = CheckPoint("max", max); !s.ok()) return s;
  const Vec3d half = (max - min) * 0.5;
  for (int i = 0; i < 3; ++i) {
    if (half[i] >= 1 / kMaxMagnitude) continue;
    const char axis = "xyz"[i];
    return absl::InvalidArgumentError(
        absl::StrCat("max.", std::string(1, axis), ": expected more than min.",
                     std::string(1, axis), " = ", min[i], ", got ", max[i]));
  }
  auto frame = Compose({(min + max) * 0.5, kWorldAxes, half}, map);
  if (!frame.ok()) return frame.status();
  return BoxShape{*frame};
}

absl::StatusOr<Shape> MakeFrustum(const FrustumParameters& p, const AffineMap& map) {
  if (auto s = CheckPoint("base", p.base); !s.ok()) return s;
  if (auto s = CheckPoint("top", p.top); !s.ok()) return s;
  if (auto s = CheckRadii(p); !s.ok()) return s;
  const Vec3d axis = p.top - p.base;
  const double height = Length(axis);
  if (!(height >= 1 / kMaxMagnitude)) {
    return absl::InvalidArgumentError(
        absl::StrCat("top: expected a point other than base, got ", Text(p.top)));
  }
  const double radius = std::max(p.base_radius, p.top_radius);
  auto frame = Compose({p.base, BasisAbout(Unit(axis)), {radius, radius, height}}, map);
  if (!frame.ok()) return frame.status();
  return FrustumShape{*frame, p.base_radius / radius, p.top_radius / radius, p.open};
}

absl::StatusOr<Shape> MakeDisc(const Vec3d& center, const Vec3d& normal, double radius,
                               const AffineMap& map) {
  if (auto s = CheckPoint("center", center); !s.ok()) return s;
  if (auto s = CheckDirection("normal", normal); !s.ok()) return s;
  if (auto s = CheckLength("radius", radius); !s.ok()) return s;
  auto frame = Compose({center, BasisAbout(Unit(normal)), {radius, radius, radius}}, map);
  if (!frame.ok()) return frame.status();
  // The gradient of the object's z is normal to the disc in the world, whatever the map shears.
  return DiscShape{*frame, {Unit(frame->object_from_world.row[2]), frame->center}};
}

}  // namespace linetree
