// How far hits and normals are off, beside the bounds that intersect.h publishes. All shapes, over
// twelve decades of size, up to a million sizes from the world's origin and from the eye.
#include <gtest/gtest.h>

#include <iostream>

#include "core/scene/support.h"
#include "core/trace/intersect.h"
#include "tests/support/shape_points.h"

namespace linetree {
namespace {

using test::kShapeKinds;
using test::Random;
using test::ShapeKind;
using Wide = long double;
using WideVec = Vec3<Wide>;

constexpr uint64_t kSeed = 20261;
constexpr int kShapesPerKind = 600;
constexpr int kRaysPerShape = 60;

// How far a point is from a face's surface, extended beyond its rim, in a wider type.
struct DistanceFrom {
  int face;
  WideVec x;

  WideVec In(const AffineFrame& frame) const {
    return frame.object_from_world * (x - frame.center);
  }
  // Of a function with value f and gradient g in object space.
  static Wide Of(const AffineFrame& frame, Wide f, const WideVec& g) {
    return std::abs(f) / Length(MultiplyTransposed(frame.object_from_world, g));
  }

  Wide operator()(const SphereShape& s) const {
    const WideVec p = In(s.frame);
    return Of(s.frame, Length(p) - 1, Normalized(p));
  }
  Wide operator()(const BoxShape& s) const {
    WideVec g;
    g[face / 2] = face % 2 == 0 ? -1 : 1;
    return Of(s.frame, Dot(In(s.frame), g) - 1, g);
  }
  Wide operator()(const FrustumShape& s) const {
    const WideVec p = In(s.frame);
    if (face != kLateralFace) return Of(s.frame, p.z - (face == kTopFace ? 1 : 0), {0, 0, 1});
    const Wide taper = Wide(s.top_radius) - s.base_radius, r = std::hypot(p.x, p.y);
    const WideVec g = r > 0 ? WideVec{p.x / r, p.y / r, -taper} : WideVec{0, 0, 1};
    return Of(s.frame, r - (s.base_radius + taper * p.z), g);
  }
  Wide operator()(const DiscShape& s) const { return std::abs(SignedDistance(s.plane, x)); }
  Wide operator()(const PolygonShape& s) const { return std::abs(SignedDistance(s.plane, x)); }
  Wide operator()(const TriangleShape& s) const { return (*this)(s.polygon); }
  Wide operator()(const PolyhedronShape& s) const {
    return std::abs(SignedDistance(s.faces[static_cast<size_t>(face)], x));
  }
};

Vec3d MiddleOfWorld(const Shape& shape) { return MiddleOf(shape); }

// A shape somewhere, and a ray that is likely to meet it: aimed into it, at its rim or along it.
struct Placed {
  Shape shape;
  Vec3d middle;
  double reach;  // of the shape about its middle
};
Placed Place(ShapeKind kind, Random& random) {
  const double size = random.LogUniform(1e-6, 1e6);
  const double away = random.Below(2) == 0 ? 0 : size * random.LogUniform(1, 1e6);
  Placed placed{test::RandomShape(kind, random, size, random.Direction() * away), {}, 0};
  placed.middle = MiddleOfWorld(placed.shape);
  placed.reach = Reach(placed.shape, placed.middle);
  return placed;
}
Ray RayAt(const Placed& placed, Random& random) {
  const double away = placed.reach * random.LogUniform(1, 1e6);
  const Vec3d origin = placed.middle + random.Direction() * away;
  Vec3d target = std::visit(test::PointOf{random}, placed.shape);
  if (random.Below(3) > 0) target = target + (placed.middle - target) * random.Unit();
  return {origin, Normalized(target - origin)};
}

template <class Fn>
void ForHits(ShapeKind kind, Fn&& fn) {
  Random random(kSeed + static_cast<uint64_t>(kind));
  for (int i = 0; i < kShapesPerKind; ++i) {
    const Placed placed = Place(kind, random);
    for (int k = 0; k < kRaysPerShape; ++k) {
      const Ray ray = RayAt(placed, random);
      for (const auto& crossing : LineCrossings(placed.shape, ray.origin, ray.direction)) {
        fn(placed, ray, crossing);
      }
    }
  }
}

TEST(Rounding, HitsAreOnTheirSurface) {
  for (const ShapeKind kind : kShapeKinds) {
    double largest = 0;
    int hits = 0;
    ForHits(kind, [&](const Placed& placed, const Ray& ray, const Crossing<double>& crossing) {
      const Vec3d point = ray.origin + ray.direction * crossing.t;
      const DistanceFrom distance{crossing.face, CastVec3<Wide>(point)};
      const double off = static_cast<double>(std::visit(distance, placed.shape));
      const double span = Length(ray.origin - placed.middle) + Length(placed.middle) + placed.reach;
      const double bound = kHitRounding * ConditionOf(placed.shape) * span;
      largest = std::max(largest, off / bound);
      ++hits;
    });
    std::cout << test::NameOf(kind) << ": " << hits << " hits, largest error / bound " << largest
              << "\n";
    EXPECT_LE(largest, 1) << test::NameOf(kind) << ", seed " << kSeed;
    EXPECT_GT(hits, kShapesPerKind * kRaysPerShape / 3) << test::NameOf(kind);
  }
}

TEST(Rounding, NormalsAreThoseOfTheirPoint) {
  for (const ShapeKind kind : kShapeKinds) {
    double largest = 0;
    ForHits(kind, [&](const Placed& placed, const Ray& ray, const Crossing<double>& crossing) {
      const Vec3d point = ray.origin + ray.direction * crossing.t;
      const Vec3d normal = FacingNormal(placed.shape, crossing.face, point, ray.direction);
      const WideVec truth = FacingNormal(placed.shape, crossing.face, CastVec3<Wide>(point),
                                         CastVec3<Wide>(ray.direction));
      const WideVec same = Dot(truth, normal) < 0 ? -truth : truth;  // across the ray: either
      const double error = static_cast<double>(Length(CastVec3<Wide>(normal) - same));
      double condition = ConditionOf(placed.shape);
      if (const auto* f = std::get_if<FrustumShape>(&placed.shape); f && crossing.face == 0) {
        const Vec3d p = f->frame.object_from_world * (point - f->frame.center);
        condition /= std::sqrt(std::hypot(p.x, p.y));
      }
      largest = std::max(largest, error / (kNormalRounding * condition * condition));
    });
    std::cout << test::NameOf(kind) << ": largest error / bound " << largest << "\n";
    EXPECT_LE(largest, 1) << test::NameOf(kind) << ", seed " << kSeed;
  }
}

}  // namespace
}  // namespace linetree
