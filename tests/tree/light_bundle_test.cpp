#include "core/tree/light_bundle.h"

#include <gtest/gtest.h>

#include "tests/support/random_scene.h"

namespace linetree {
namespace {

// More objects than HullViews has places, asked in any order, face by face and by any margin.
TEST(HullViews, SayWhatComputingAnewSays) {
  test::Random random(31);
  std::vector<Shape> shapes;
  std::vector<FacePlanes> planes;
  for (int i = 0; i < 80; ++i) {
    const auto kind = test::kShapeKinds[static_cast<size_t>(i) % test::kShapeKinds.size()];
    shapes.push_back(test::RandomShape(kind, random, 1, random.InCube(2)));
    planes.push_back(FacePlanesOf(shapes.back()));
  }
  HullViews views;
  int apart = 0, near = 0;
  for (int round = 0; round < 20; ++round) {
    PatchHull hull;
    const Vec3d center = random.InCube(2);
    const double size = random.LogUniform(0.1, 2);
    for (Vec3d& p : hull.points) p = center + random.InCube(size);
    views.Begin(hull);
    for (int i = 0; i < 600; ++i) {
      const int object = random.Below(static_cast<int>(shapes.size()));
      const auto index = static_cast<size_t>(object);
      for (size_t face = 0; face < planes[index].faces.size(); ++face) {
        const Heights heights = views.HeightsAbove(object, planes[index], face);
        const Heights anew = HeightsOf(hull, planes[index].faces[face]);
        EXPECT_EQ(heights.low, anew.low);
        EXPECT_EQ(heights.high, anew.high);
      }
      const double margin = random.LogUniform(1e-3, 3);
      const bool is_apart = views.IsApart(object, shapes[index], margin);
      EXPECT_EQ(is_apart, CertainlyApart(hull.points, shapes[index], margin));
      (is_apart ? apart : near) += 1;
    }
  }
  EXPECT_GT(apart, 1000);
  EXPECT_GT(near, 1000);
}

// What has separated one bundle is tried first on the next: it neither helps those that meet nor
// keeps those that do not from being found apart.
TEST(HullViews, SayOfBundlesWhatComputingAnewSays) {
  test::Random random(32);
  std::vector<Shape> shapes;
  for (int i = 0; i < 40; ++i) {
    const auto kind = test::kShapeKinds[static_cast<size_t>(i) % test::kShapeKinds.size()];
    shapes.push_back(test::RandomShape(kind, random, 1, random.InCube(2)));
  }
  HullViews views;
  int apart = 0, near = 0;
  for (int round = 0; round < 20; ++round) {
    PatchHull hull;
    const Vec3d center = random.InCube(2);
    for (Vec3d& p : hull.points) p = center + random.InCube(0.5);
    views.Begin(hull);
    for (int i = 0; i < 1000; ++i) {
      const int object = random.Below(static_cast<int>(shapes.size()));
      std::array<Vec3d, 9> points;
      std::copy(hull.points.begin(), hull.points.end(), points.begin());
      points[8] = center + random.InCube(8);
      const Shape& shape = shapes[static_cast<size_t>(object)];
      const double margin = random.LogUniform(1e-9, 1e-3);
      const bool is_apart = views.IsBundleApart(object, shape, points, margin);
      EXPECT_EQ(is_apart, CertainlyApart(points, shape, margin));
      (is_apart ? apart : near) += 1;
    }
  }
  EXPECT_GT(apart, 1000);
  EXPECT_GT(near, 500);
}

}  // namespace
}  // namespace linetree
