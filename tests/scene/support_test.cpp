#include "core/scene/support.h"

#include <gtest/gtest.h>

#include "tests/support/shape_points.h"

namespace linetree {
namespace {

using test::kShapeKinds;
using test::NameOf;
using test::PointOf;
using test::Random;

constexpr uint64_t kSeed = 41;

using Wide = long double;

Vec3<Wide> Widened(const Vec3d& v) { return CastVec3<Wide>(v); }

// The same suprema in a wider type, by the definitions of shape.h.
struct WideSupport {
  Vec3<Wide> n, origin;

  Vec3<Wide> Gradient(const AffineFrame& f) const {
    const auto& row = f.world_from_object.row;
    return Widened(row[0]) * n.x + Widened(row[1]) * n.y + Widened(row[2]) * n.z;
  }
  Wide At(const Vec3d& x) const { return Dot(Widened(x) - origin, n); }
  static Wide Flat(const Vec3<Wide>& g) { return std::sqrt(g.x * g.x + g.y * g.y); }

  Wide operator()(const SphereShape& s) const {
    return At(s.frame.center) + Length(Gradient(s.frame));
  }
  Wide operator()(const BoxShape& s) const {
    const auto g = Gradient(s.frame);
    return At(s.frame.center) + std::abs(g.x) + std::abs(g.y) + std::abs(g.z);
  }
  Wide operator()(const FrustumShape& s) const {
    const auto g = Gradient(s.frame);
    return At(s.frame.center) + std::max(s.base_radius * Flat(g), s.top_radius * Flat(g) + g.z);
  }
  Wide operator()(const DiscShape& s) const { return At(s.frame.center) + Flat(Gradient(s.frame)); }
  Wide OfVertices(const std::vector<Vec3d>& vertices) const {
    Wide most = At(vertices[0]);
    for (const Vec3d& v : vertices) most = std::max(most, At(v));
    return most;
  }
  Wide operator()(const PolygonShape& s) const { return OfVertices(s.vertices); }
  Wide operator()(const TriangleShape& s) const { return OfVertices(s.polygon.vertices); }
  Wide operator()(const PolyhedronShape& s) const { return OfVertices(s.vertices); }
};

// A direction of random length; sometimes along axes of the world.
Vec3d RandomNormal(Random& random) {
  Vec3d n = random.Direction() * random.LogUniform(1e-9, 1e9);
  if (random.Below(4) == 0) n[random.Below(3)] = 0;
  if (random.Below(4) == 0) n[random.Below(3)] = 0;
  return n == Vec3d{} ? Vec3d{0, 0, 1} : n;
}

// Shapes of 1e-6 to 1e6 at up to a million sizes from the origin, seen from the world's origin or
// from nearby.
struct Case {
  Shape shape;
  Vec3d origin;
};
Case RandomCase(test::ShapeKind kind, Random& random) {
  const double size = random.LogUniform(1e-6, 1e6);
  const Vec3d center = random.Direction() * (size * random.LogUniform(0.1, 1e6));
  const Vec3d near = center + random.InCube(3 * size);
  return {test::RandomShape(kind, random, size, center), random.Below(2) == 0 ? near : Vec3d{}};
}

TEST(Support, IsExactToItsRounding) {
  double largest = 0;
  for (const auto kind : kShapeKinds) {
    Random random(kSeed);
    SCOPED_TRACE(testing::Message() << NameOf(kind) << ", seed " << kSeed);
    for (int k = 0; k < 20000; ++k) {
      const auto [shape, origin] = RandomCase(kind, random);
      const Vec3d n = RandomNormal(random);
      const Wide exact = std::visit(WideSupport{Widened(n), Widened(origin)}, shape);
      const double error = std::abs(static_cast<double>(Support(shape, n, origin) - exact));
      const double unit = Length(n) * Reach(shape, origin);
      ASSERT_LE(error, kSupportRounding * unit);
      largest = std::max(largest, error / (kSupportRounding * unit));
    }
  }
  RecordProperty("largest_error_of_promised", std::to_string(largest));
}

TEST(Support, BoundsSurfacePointsTightly) {
  for (const auto kind : kShapeKinds) {
    Random random(kSeed);
    SCOPED_TRACE(testing::Message() << NameOf(kind) << ", seed " << kSeed);
    for (int k = 0; k < 50; ++k) {
      const auto [shape, origin] = RandomCase(kind, random);
      const Vec3d n = random.Direction();
      const double high = Support(shape, n, origin), low = -Support(shape, -n, origin);
      // Samples are rounded in world coordinates.
      const double rounding = 4 * kSupportRounding * (Reach(shape, {}) + Reach(shape, origin));
      double sampled_high = -Box3::kInf, sampled_low = Box3::kInf;
      for (int i = 0; i < 4000; ++i) {
        const Vec3d x = std::visit(PointOf{random}, shape) - origin;
        sampled_high = std::max(sampled_high, Dot(n, x));
        sampled_low = std::min(sampled_low, Dot(n, x));
        ASSERT_LE(Length(x), Reach(shape, origin) + rounding);
      }
      EXPECT_LE(sampled_high, high + rounding);
      EXPECT_GE(sampled_low, low - rounding);
      EXPECT_GE(sampled_high - sampled_low, 0.85 * (high - low) - rounding);
    }
  }
}

// A point is in a closed convex set when no direction sees it beyond the support.
void ExpectInHull(const Shape& shape, const Vec3d& origin, const Vec3d& x, Random& random) {
  const double rounding = 2 * kSupportRounding * Reach(shape, origin);
  for (int i = 0; i < 30; ++i) {
    const Vec3d m = random.Direction();
    ASSERT_LE(Dot(m, x), Support(shape, m, origin) + rounding);
  }
}

TEST(SupportPoint, IsTheFarthestPointOfTheHull) {
  for (const auto kind : kShapeKinds) {
    Random random(kSeed);
    SCOPED_TRACE(testing::Message() << NameOf(kind) << ", seed " << kSeed);
    for (int k = 0; k < 2000; ++k) {
      const auto [shape, origin] = RandomCase(kind, random);
      const Vec3d n = RandomNormal(random);
      const Vec3d x = SupportPoint(shape, n, origin);
      ExpectInHull(shape, origin, x, random);
      ExpectInHull(shape, origin, MiddleOf(shape, origin), random);
      ASSERT_NEAR(Dot(n, x), Support(shape, n, origin),
                  2 * kSupportRounding * Length(n) * Reach(shape, origin));
    }
  }
}

TEST(SupportPoint, MiddleIsInTheMiddle) {
  Random random(kSeed);
  for (const auto kind : kShapeKinds) {
    SCOPED_TRACE(NameOf(kind));
    for (int k = 0; k < 200; ++k) {
      const Shape shape = test::RandomShape(kind, random, 1, {5, 6, 7});
      const Vec3d n = random.Direction();
      const double high = Support(shape, n), low = -Support(shape, -n);
      EXPECT_LE(Dot(n, MiddleOf(shape)), high - 0.05 * (high - low) + 1e-12);
    }
  }
}

// Directions along which whole circles, edges or faces are equally far, of any length.
TEST(SupportPoint, HandlesZeroComponents) {
  const std::vector<Shape> shapes = {test::Sphere({1, 0, 0}, 1), test::Box({0, 0, 0}, {2, 2, 2}),
                                     test::Frustum({0, 0, 0}, {0, 0, 2}, 1, 1),
                                     test::Frustum({0, 0, 0}, {0, 0, 2}, 1, 0),
                                     test::Disc({0, 0, 1}, {0, 0, 1}, 1)};
  for (const Shape& shape : shapes) {
    for (const double length : {1e-300, 1.0, 1e300}) {
      for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {-1.0, 1.0}) {
          Vec3d unit;
          unit[axis] = sign;
          const Vec3d x = SupportPoint(shape, unit * length);
          ASSERT_TRUE(IsFinite(x));
          EXPECT_NEAR(Dot(unit, x), Support(shape, unit), 1e-14);
        }
      }
    }
    EXPECT_EQ(Support(shape, Vec3d{}), 0);
  }
}

}  // namespace
}  // namespace linetree
