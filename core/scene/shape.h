// The convex primitives, in the form in which rays meet them.
//
// Frames
//   world   right-handed, the scene file's units.
//   object  where a curved shape is canonical: p_object = object_from_world * (p_world - center).
//           The map is affine, so straight lines stay straight and a ray's parameter t is the same
//           in both frames (directions are not normalised in object space).
//
// Faces (Hit::face) are numbered per shape:
//   sphere 0 · box 0..5 = -x +x -y +y -z +z · frustum 0 lateral, 1 base cap, 2 top cap · disc 0 ·
//   polygon 0 · triangle 0 · polyhedron one per half-space.
//
// Solids (sphere, box, capped frustum, polyhedron) have an inside. Open frustums and planar shapes
// are surfaces: both sides are seen and lit, transmitted rays go straight on.
#pragma once

#include <array>
#include <variant>
#include <vector>

#include "core/math/box3.h"
#include "core/math/vec3.h"

namespace linetree {

// An invertible affine map. Rows of object_from_world are the gradients of the object coordinates.
struct AffineFrame {
  Vec3d center;            // world
  Mat3 object_from_world;  // linear part
  Mat3 world_from_object;  // its inverse
  bool operator==(const AffineFrame&) const = default;
};

// Points x with normal.(x - point) = 0; normal is unit length. A reference point instead of an
// offset keeps the distance accurate far from the origin.
struct Plane {
  Vec3d normal;
  Vec3d point;
  bool operator==(const Plane&) const = default;
};
template <class S>
S SignedDistance(const Plane& plane, const Vec3<S>& x) {
  return Dot(x - plane.point, plane.normal);
}

// Object space: |p| = 1.
struct SphereShape {
  AffineFrame frame;
  bool operator==(const SphereShape&) const = default;
};
// Object space: [-1, 1]^3.
struct BoxShape {
  AffineFrame frame;
  bool operator==(const BoxShape&) const = default;
};
// Object space: x^2 + y^2 = w(z)^2 with w(z) = base_radius + (top_radius - base_radius) z, z in
// [0, 1]; radii in [0, 1], the larger one is 1. Cylinders have equal radii.
struct FrustumShape {
  AffineFrame frame;
  double base_radius = 1;
  double top_radius = 1;
  bool open = false;
  bool operator==(const FrustumShape&) const = default;
};
// Object space: z = 0, x^2 + y^2 <= 1.
struct DiscShape {
  AffineFrame frame;
  Plane plane;  // world
  bool operator==(const DiscShape&) const = default;
};
// World space: counter-clockwise about plane.normal; edges[i] passes through vertices i and i+1,
// its normal lies in the plane and points outwards.
struct PolygonShape {
  std::vector<Vec3d> vertices;
  Plane plane;
  std::vector<Plane> edges;
  bool operator==(const PolygonShape&) const = default;
};
// A triangle whose shading normal is interpolated between three unit vectors.
struct TriangleShape {
  PolygonShape polygon;
  std::array<Vec3d, 3> normals;
  bool operator==(const TriangleShape&) const = default;
};
// World space: normal.(x - point) <= 0 for every face; bounded, with non-empty interior.
struct PolyhedronShape {
  std::vector<Plane> faces;
  std::vector<Vec3d> vertices;
  bool operator==(const PolyhedronShape&) const = default;
};

using Shape = std::variant<SphereShape, BoxShape, FrustumShape, DiscShape, PolygonShape,
                           TriangleShape, PolyhedronShape>;

// Whether the shape encloses a volume (transmitted rays refract into it).
bool IsSolid(const Shape& shape);

// Whether the shape lies in one plane.
bool IsPlanar(const Shape& shape);

// Number of faces.
int FaceCount(const Shape& shape);

// The smallest axis-aligned box that encloses the shape, widened outwards by kBoundsPad so that
// rounding in its computation loses nothing.
Box3 Bounds(const Shape& shape);

// Relative to the largest coordinate of the box: 2^-48, sixteen times the rounding of the at most
// eight operations behind a bound.
inline constexpr double kBoundsPad = 0x1p-48;

// The plane and edges of a planar convex polygon with the given vertices (three or more, in either
// orientation; the caller has checked planarity and convexity).
PolygonShape MakePolygon(std::vector<Vec3d> vertices);

}  // namespace linetree
