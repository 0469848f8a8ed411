// Random points of shapes.
#pragma once

#include <cmath>
#include <numbers>

#include "tests/support/random_shapes.h"

namespace linetree::test {

inline Vec3d ToWorld(const AffineFrame& frame, const Vec3d& p) {
  return frame.world_from_object * p + frame.center;
}

inline Vec3d OnCircle(Random& random, double radius, double z) {
  const double angle = random.Uniform(0, 2 * std::numbers::pi);
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

// Points of the surface (of polygons: of the rim), by the definition in object space or by its
// vertices.
struct PointOf {
  Random& random;
  Vec3d operator()(const SphereShape& s) const { return ToWorld(s.frame, random.Direction()); }
  Vec3d operator()(const BoxShape& s) const {
    Vec3d p = random.InCube(1);
    p[random.Below(3)] = random.Below(2) == 0 ? -1 : 1;
    return ToWorld(s.frame, p);
  }
  Vec3d operator()(const FrustumShape& s) const {
    const double z = random.Below(3) == 0 ? random.Below(2) : random.Unit();
    const double w = s.base_radius + (s.top_radius - s.base_radius) * z;
    return ToWorld(s.frame, OnCircle(random, w, z));
  }
  Vec3d operator()(const DiscShape& s) const { return ToWorld(s.frame, OnCircle(random, 1, 0)); }
  Vec3d operator()(const PolygonShape& s) const {
    const size_t i = static_cast<size_t>(random.Below(static_cast<int>(s.vertices.size())));
    const Vec3d& a = s.vertices[i];
    return a + (s.vertices[(i + 1) % s.vertices.size()] - a) * random.Unit();
  }
  Vec3d operator()(const TriangleShape& s) const { return (*this)(s.polygon); }
  // Where a ray from the middle leaves the first half-space it leaves.
  Vec3d operator()(const PolyhedronShape& s) const {
    Vec3d middle;
    for (const Vec3d& v : s.vertices)
      middle = middle + v * (1.0 / static_cast<double>(s.vertices.size()));
    const Vec3d d = random.Direction();
    double t = Box3::kInf;
    for (const Plane& face : s.faces) {
      const double slope = Dot(d, face.normal);
      if (slope > 0) t = std::min(t, -SignedDistance(face, middle) / slope);
    }
    return middle + d * t;
  }
};

}  // namespace linetree::test
