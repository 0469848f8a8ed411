// Where rays meet one object of any shape, and how it lies there.
#pragma once

#include <algorithm>
#include <cmath>
#include <variant>

#include "core/trace/intersect_planar.h"
#include "core/trace/intersect_quadric.h"

namespace linetree {

// Rounding, with the condition k = ConditionOf(shape), the shape's middle m and its reach r about
// m:
//
// * The point o + t d of a crossing is within kHitRounding * k * (|o - m| + |m| + r) of the surface
//   of its face, also where the line grazes it and t itself is far off. Derivation: the chain from
//   o to the point has some 16 roundings (3 to the shape's centre, 4 into object space, 6 in the
//   root, 3 back), each of at most that length seen through the map and back; doubled.
// * FacingNormal is within kNormalRounding * k^2 of the unit normal of the same point: 12 roundings
//   (4 into object space, 4 back, 4 to unit length), each seen through the map twice; doubled.
//   Times 1 / w on the lateral face of a frustum where its radius is w in object space (a cone's
//   apex has no normal), and times the longest side over the least height in a triangle with
//   normals whose mean is about as long as they are.
inline constexpr double kHitRounding = 0x1p-48;
inline constexpr double kNormalRounding = 0x1p-48;

// Frobenius norms of the maps into object space and out of it, multiplied: 3 for balls and cubes,
// and for shapes that are given in world space.
inline double ConditionOf(const Shape& shape) {
  return std::visit(
      []<class T>(const T& s) {
        if constexpr (requires { s.frame; }) {
          double object = 0, world = 0;
          for (size_t i = 0; i < 3; ++i) {
            object += LengthSquared(s.frame.object_from_world.row[i]);
            world += LengthSquared(s.frame.world_from_object.row[i]);
          }
          return std::sqrt(object) * std::sqrt(world);
        } else {
          return 3.0;
        }
      },
      shape);
}

// All crossings of the whole line o + t d, t in (-inf, inf).
template <class S>
Crossings<S> LineCrossings(const Shape& shape, const Vec3<S>& origin, const Vec3<S>& direction) {
  return std::visit([&](const auto& s) { return LineCrossings(s, origin, direction); }, shape);
}

// Crossings of the ray that starts on `face` of this very shape and leaves into `side`.
template <class S>
Crossings<S> CrossingsFromStart(const Shape& shape, const Vec3<S>& origin, const Vec3<S>& direction,
                                int face, Side side) {
  Crossings<S> crossings;
  if (side == Side::kOutside || IsPlanar(shape)) return crossings;
  std::visit(
      [&]<class T>(const T& s) {
        if constexpr (std::is_same_v<T, FrustumShape>) {
          if (s.open) {
            crossings = FarWallCrossing(s, origin, direction);
            return;
          }
        }
        if constexpr (requires { ExitCrossing(s, origin, direction, face); }) {
          crossings.Append(ExitCrossing(s, origin, direction, face));
        }
      },
      shape);
  return crossings;
}

// Crossings of a ray with t > 0 (from a start on this object, also t = 0: see Chord::Exit).
template <class S>
Crossings<S> RayCrossings(const Shape& shape, int object, const Vec3<S>& origin,
                          const Vec3<S>& direction, const RayStart& start) {
  if (start.object == object) {
    return CrossingsFromStart(shape, origin, direction, start.face, start.side);
  }
  Crossings<S> ahead;
  for (const Crossing<S>& crossing : LineCrossings(shape, origin, direction)) {
    if (crossing.t > 0) ahead.Append(crossing);
  }
  return ahead;
}

// Outward normal of a face at a point on it, of any length; zero at a cone's apex. The shading
// normal, which is unit, for TriangleShape.
template <class S>
Vec3<S> OutwardNormal(const SphereShape& shape, int /*face*/, const Vec3<S>& point) {
  const Mat3& m = shape.frame.object_from_world;
  return MultiplyTransposed(m, Vec3<S>(m * (point - shape.frame.center)));
}
template <class S>
Vec3<S> OutwardNormal(const BoxShape& shape, int face, const Vec3<S>& /*point*/) {
  const Vec3d& row = shape.frame.object_from_world.row[static_cast<size_t>(face / 2)];
  return CastVec3<S>(face % 2 == 0 ? -row : row);
}
template <class S>
Vec3<S> OutwardNormal(const FrustumShape& shape, int face, const Vec3<S>& point) {
  const Mat3& m = shape.frame.object_from_world;
  if (face != kLateralFace) return CastVec3<S>(face == kBaseFace ? -m.row[2] : m.row[2]);
  const Vec3<S> p = m * (point - shape.frame.center);
  const double taper = shape.top_radius - shape.base_radius;
  const S w = S(shape.base_radius) + S(taper) * p.z;
  return MultiplyTransposed(m, Vec3<S>{p.x, p.y, -w * S(taper)});
}
template <class S>
Vec3<S> OutwardNormal(const DiscShape& shape, int /*face*/, const Vec3<S>& /*point*/) {
  return CastVec3<S>(shape.plane.normal);
}
template <class S>
Vec3<S> OutwardNormal(const PolygonShape& shape, int /*face*/, const Vec3<S>& /*point*/) {
  return CastVec3<S>(shape.plane.normal);
}
template <class S>
Vec3<S> OutwardNormal(const PolyhedronShape& shape, int face, const Vec3<S>& /*point*/) {
  return CastVec3<S>(shape.faces[static_cast<size_t>(face)].normal);
}
// Barycentric weights are distances from the edge opposite the vertex, relative to the vertex's
// own.
template <class S>
Vec3<S> OutwardNormal(const TriangleShape& shape, int /*face*/, const Vec3<S>& point) {
  Vec3<S> sum;
  for (size_t i = 0; i < 3; ++i) {
    const Plane& opposite = shape.polygon.edges[(i + 1) % 3];
    const double height = SignedDistance(opposite, shape.polygon.vertices[i]);
    const S weight = SignedDistance(opposite, point) / S(height);
    sum = sum + CastVec3<S>(shape.normals[i]) * weight;
  }
  return LengthSquared(sum) > 0 ? sum : CastVec3<S>(shape.polygon.plane.normal);
}

// Unit shading normal at a point of a face, turned against `direction` (n.d <= 0). At a cone's
// apex, which has no normal, straight against it.
template <class S>
Vec3<S> FacingNormal(const Shape& shape, int face, const Vec3<S>& point, const Vec3<S>& direction) {
  const Vec3<S> outward =
      std::visit([&](const auto& s) { return OutwardNormal(s, face, point); }, shape);
  if (!(LengthSquared(outward) > 0)) return Normalized(-direction);
  const Vec3<S> normal = Normalized(outward);
  return Dot(normal, direction) > 0 ? -normal : normal;
}

// Whether a point lies strictly inside a solid.
template <class S>
bool SolidContains(const SphereShape& shape, const Vec3<S>& point) {
  return LengthSquared(shape.frame.object_from_world * (point - shape.frame.center)) < 1;
}
template <class S>
bool SolidContains(const BoxShape& shape, const Vec3<S>& point) {
  using std::abs;
  const Vec3<S> p = shape.frame.object_from_world * (point - shape.frame.center);
  return abs(p.x) < 1 && abs(p.y) < 1 && abs(p.z) < 1;
}
template <class S>
bool SolidContains(const FrustumShape& shape, const Vec3<S>& point) {
  const Vec3<S> p = shape.frame.object_from_world * (point - shape.frame.center);
  const S w = S(shape.base_radius) + S(shape.top_radius - shape.base_radius) * p.z;
  return p.z > 0 && p.z < 1 && p.x * p.x + p.y * p.y < w * w;
}
template <class S>
bool SolidContains(const PolyhedronShape& shape, const Vec3<S>& point) {
  return std::all_of(shape.faces.begin(), shape.faces.end(),
                     [&](const Plane& face) { return SignedDistance(face, point) < 0; });
}
// Never for shapes that are not solid.
template <class S>
bool ContainsStrictly(const Shape& shape, const Vec3<S>& point) {
  return std::visit(
      [&](const auto& s) {
        if constexpr (requires { SolidContains(s, point); }) {
          return IsSolid(shape) && SolidContains(s, point);
        } else {
          return false;
        }
      },
      shape);
}

}  // namespace linetree
