#include "core/trace/intersect_planar.h"

#include <gtest/gtest.h>

#include "core/trace/intersect.h"
#include "tests/support/random.h"
#include "tests/support/random_shapes.h"
#include "tests/support/scene_builder.h"

namespace linetree {
namespace {

using test::Random;

Crossings<double> Cross(const Shape& shape, const Vec3d& origin, const Vec3d& direction) {
  return LineCrossings(shape, origin, direction);
}

TEST(Box, FacesAreNumberedByAxisAndSign) {
  const Shape box = test::Box({-1, -2, -3}, {1, 2, 3});
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d origin{0.1, 0.2, 0.3}, direction;
    origin[axis] = -10;
    direction[axis] = 2;
    const auto crossings = Cross(box, origin, direction);
    ASSERT_EQ(crossings.count, 2);
    EXPECT_EQ(crossings.at[0].face, 2 * axis);
    EXPECT_DOUBLE_EQ(crossings.at[0].t, (10.0 - (axis + 1)) / 2);
    EXPECT_EQ(crossings.at[1].face, 2 * axis + 1);
    EXPECT_DOUBLE_EQ(crossings.at[1].t, (10.0 + (axis + 1)) / 2);
    const Vec3d normal = FacingNormal(box, crossings.at[0].face, Vec3d{}, direction);
    EXPECT_EQ(normal[axis], -1);
  }
}

// In a face's plane the solid is closed: it is met; beside it, it is not.
TEST(Box, LinesParallelToFaces) {
  const Shape box = test::Box({-1, -1, -1}, {1, 1, 1});
  EXPECT_EQ(Cross(box, {-5, 1, 0}, {1, 0, 0}).count, 2);
  EXPECT_EQ(Cross(box, {-5, 1, 1}, {1, 0, 0}).count, 2);
  EXPECT_EQ(Cross(box, {-5, 1.0000001, 0}, {1, 0, 0}).count, 0);
  EXPECT_EQ(Cross(box, {-5, 0, -1.0000001}, {1, 0, -0.0}).count, 0);
}

TEST(Polyhedron, AxisAlignedOneIsTheBox) {
  Random random(1);
  const Shape box = test::Box({-1, -2, -3}, {1, 2, 3});
  const Shape polyhedron = test::Polyhedron({{{-1, 0, 0}, 1},
                                             {{1, 0, 0}, 1},
                                             {{0, -1, 0}, 2},
                                             {{0, 1, 0}, 2},
                                             {{0, 0, -1}, 3},
                                             {{0, 0, 1}, 3}});
  for (int k = 0; k < 10000; ++k) {
    const Vec3d origin = random.InCube(6);
    const Vec3d direction = random.InCube(2) - origin;
    const auto a = Cross(box, origin, direction);
    const auto b = Cross(polyhedron, origin, direction);
    ASSERT_EQ(a.count, b.count);
    for (int i = 0; i < a.count; ++i) {
      EXPECT_EQ(a.at[i].face, b.at[i].face);
      EXPECT_NEAR(a.at[i].t, b.at[i].t, 0x1p-46 * (1 + std::abs(a.at[i].t)));
    }
  }
}

TEST(Disc, RimDecides) {
  const Shape disc = test::Disc({1, 2, 3}, {0, 0, 5}, 2);
  EXPECT_EQ(Cross(disc, {1 + 1.999, 2, 10}, {0, 0, -1}).count, 1);
  EXPECT_EQ(Cross(disc, {1 + 2.001, 2, 10}, {0, 0, -1}).count, 0);
  EXPECT_EQ(Cross(disc, {1, 2, 10}, {0, 0, -1}).at[0].t, 7);
  EXPECT_EQ(Cross(disc, {1, 2, -10}, {0, 0, 2}).at[0].t, 6.5);
  EXPECT_EQ(Cross(disc, {-9, 2, 3}, {1, 0, 0}).count, 0) << "in its plane";
}

// Points of the plane inside and outside the loop, made from the vertices and not by tracing.
TEST(Polygon, InsideAndOutsideOfRandomLoops) {
  Random random(2);
  for (int k = 0; k < 20000; ++k) {
    const std::vector<Vec3d> loop = test::RandomLoop(random, 3 + random.Below(6));
    const AffineMap map = test::RandomMap(random, 1, random.InCube(3));
    const Shape polygon = test::Good(MakeConvexPolygon(loop, map));
    const size_t i = static_cast<size_t>(random.Below(static_cast<int>(loop.size())));
    const Vec3d a = loop[i];
    const Vec3d b = loop[(i + 1) % loop.size()];
    const Vec3d on_edge = a + (b - a) * random.Unit();
    const Vec3d centroid = [&] {
      Vec3d sum;
      for (const Vec3d& vertex : loop) sum = sum + vertex;
      return sum * (1.0 / static_cast<double>(loop.size()));
    }();
    const Vec3d origin = Apply(map, random.Direction() * 4 + Vec3d{0, 0, 1});
    const auto hits = [&](double stretch) {
      const Vec3d target = Apply(map, centroid + (on_edge - centroid) * stretch);
      return Cross(polygon, origin, target - origin);
    };
    const auto inside = hits(random.Uniform(0, 1 - 1e-9));
    ASSERT_EQ(inside.count, 1) << "polygon " << k;
    EXPECT_NEAR(inside.at[0].t, 1, 1e-9);
    EXPECT_EQ(inside.at[0].side, Side::kOutside);
    EXPECT_EQ(hits(random.Uniform(1 + 1e-9, 2)).count, 0) << "polygon " << k;
  }
}

TEST(SmoothTriangle, NormalIsInterpolated) {
  const std::vector<Vec3d> vertices = {{0, 0, 0}, {2, 0, 0}, {0, 4, 0}};
  const std::vector<Vec3d> normals = {{0, 0, 1}, {0.6, 0, 0.8}, {0, -0.6, 0.8}};
  const Shape triangle = test::SmoothTriangle(vertices, normals);
  Random random(3);
  for (int k = 0; k < 1000; ++k) {
    double w[3] = {random.Unit(), random.Unit(), random.Unit()};
    const double sum = w[0] + w[1] + w[2];
    Vec3d point, normal;
    for (size_t i = 0; i < 3; ++i) {
      point = point + vertices[i] * (w[i] / sum);
      normal = normal + normals[i] * (w[i] / sum);
    }
    const Vec3d from_above = FacingNormal(triangle, 0, point, Vec3d{0, 0, -1});
    EXPECT_LT(Length(from_above - Normalized(normal)), 0x1p-48);
    EXPECT_EQ(FacingNormal(triangle, 0, point, Vec3d{0, 0, 1}), -from_above);
  }
}

TEST(SmoothTriangle, NormalsThatCancelFallBackToThePlane) {
  const Shape triangle =
      test::SmoothTriangle({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}});
  EXPECT_EQ(FacingNormal(triangle, 0, Vec3d{1, 0, 0}, Vec3d{0, 0, -1}), (Vec3d{0, 0, 1}));
}

}  // namespace
}  // namespace linetree
