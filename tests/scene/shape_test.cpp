#include "core/scene/shape.h"

#include <gtest/gtest.h>

#include "tests/support/shape_points.h"

namespace linetree {
namespace {

using test::kShapeKinds;
using test::NameOf;
using test::PointOf;
using test::Random;
using test::ShapeKind;

constexpr uint64_t kSeed = 20264;

// Rounding of a sample, relative to the largest coordinate: what kBoundsPad does not promise to
// cover, since the sample is computed along another way than the bound.
constexpr double kSampleRounding = 0x1p-46;

Box3 Widened(Box3 box) {
  for (int i = 0; i < 3; ++i) {
    const double pad = kSampleRounding * std::max(std::abs(box.min[i]), std::abs(box.max[i]));
    box.min[i] -= pad;
    box.max[i] += pad;
  }
  return box;
}

// Enclosing, and tight: dense samples come close to each side.
TEST(Bounds, EncloseSurfacePointsTightly) {
  for (const ShapeKind kind : kShapeKinds) {
    Random random(kSeed);
    SCOPED_TRACE(testing::Message() << NameOf(kind) << ", seed " << kSeed);
    for (int k = 0; k < 50; ++k) {
      const double size = random.LogUniform(1e-6, 1e6);
      const Shape shape =
          RandomShape(kind, random, size, random.Direction() * (size * random.Uniform(0, 5)));
      const Box3 bounds = Bounds(shape);
      const Box3 widened = Widened(bounds);
      Box3 sampled;
      for (int i = 0; i < 4000; ++i) {
        const Vec3d point = std::visit(PointOf{random}, shape);
        ASSERT_TRUE(widened.Contains(point));
        sampled.Add(point);
      }
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GT(sampled.Extent()[axis], 0.85 * bounds.Extent()[axis]);
      }
    }
  }
}

TEST(Bounds, AreExactForAxisParallelShapes) {
  const auto expect = [](const Shape& shape, const Vec3d& min, const Vec3d& max) {
    const Box3 bounds = Bounds(shape);
    EXPECT_LT(Length(bounds.min - min), 1e-12);
    EXPECT_LT(Length(bounds.max - max), 1e-12);
  };
  expect(test::Sphere({1, 2, 3}, 2), {-1, 0, 1}, {3, 4, 5});
  expect(test::Box({1, 2, 3}, {2, 4, 6}), {1, 2, 3}, {2, 4, 6});
  expect(test::Frustum({0, 0, 1}, {0, 0, 4}, 2, 1), {-2, -2, 1}, {2, 2, 4});
  expect(test::Disc({0, 0, 1}, {0, 3, 0}, 2), {-2, 0, -1}, {2, 0, 3});
}

TEST(Shape, SolidsPlanarShapesAndFaces) {
  struct Case {
    ShapeKind kind;
    bool solid, planar;
    int faces;  // 0: not fixed
  };
  Random random(1);
  for (const Case& c : {Case{ShapeKind::kSphere, true, false, 1},
                        {ShapeKind::kBox, true, false, 6},
                        {ShapeKind::kCylinder, true, false, 3},
                        {ShapeKind::kCone, true, false, 3},
                        {ShapeKind::kFrustum, true, false, 3},
                        {ShapeKind::kOpenCylinder, false, false, 1},
                        {ShapeKind::kOpenCone, false, false, 1},
                        {ShapeKind::kDisc, false, true, 1},
                        {ShapeKind::kPolygon, false, true, 1},
                        {ShapeKind::kSmoothTriangle, false, true, 1},
                        {ShapeKind::kPolyhedron, true, false, 0}}) {
    SCOPED_TRACE(NameOf(c.kind));
    const Shape shape = RandomShape(c.kind, random, 1, {});
    EXPECT_EQ(IsSolid(shape), c.solid);
    EXPECT_EQ(IsPlanar(shape), c.planar);
    if (c.faces > 0) {
      EXPECT_EQ(FaceCount(shape), c.faces);
    }
  }
  EXPECT_EQ(FaceCount(test::Polyhedron(
                {{{-1, 0, 0}, 0}, {{0, -1, 0}, 0}, {{0, 0, -1}, 0}, {{1, 1, 1}, 1}})),
            4);
}

// In either orientation: edges face outwards, the normal is unit and right-handed with the loop.
TEST(MakePolygon, EdgesFaceOutwards) {
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    std::vector<Vec3d> loop = test::RandomLoop(random, 3 + random.Below(6));
    const bool reversed = random.Below(2) == 0;
    if (reversed) std::reverse(loop.begin(), loop.end());
    const PolygonShape polygon = MakePolygon(loop);
    EXPECT_NEAR(polygon.plane.normal.z, reversed ? -1 : 1, 1e-12);
    ASSERT_EQ(polygon.edges.size(), loop.size());
    for (size_t i = 0; i < loop.size(); ++i) {
      EXPECT_NEAR(Dot(polygon.edges[i].normal, polygon.plane.normal), 0, 1e-12);
      for (size_t j = 0; j < loop.size(); ++j) {
        EXPECT_LE(SignedDistance(polygon.edges[i], loop[j]), 1e-12);
      }
    }
  }
}

}  // namespace
}  // namespace linetree
