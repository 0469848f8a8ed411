#include "core/tree/ray_space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/trace/tracer.h"
#include "tests/support/random.h"
#include "tests/support/scene_builder.h"

namespace linetree {
namespace {

std::vector<Object> Objects(test::Random& random, double size, const Vec3d& at) {
  const auto p = [&](double x, double y, double z) { return at + Vec3d{x, y, z} * size; };
  const Vec3d top = at + random.Direction() * (2 * size);
  std::vector<Object> objects;
  objects.push_back(test::ObjectOf(test::Sphere(at, size)));
  objects.push_back(test::ObjectOf(test::Box(at, p(1, 0.01, 2))));
  objects.push_back(test::ObjectOf(test::Frustum(at, top, 0.5 * size, 0.2 * size)));
  objects.push_back(test::ObjectOf(test::Frustum(at, top, 0.3 * size, 0.3 * size, true)));
  objects.push_back(test::ObjectOf(test::Disc(at, random.Direction(), size)));
  objects.push_back(
      test::ObjectOf(test::Polygon({p(0, 0, 0), p(3, 0, 1), p(3, 1, 1), p(0, 1, 0)})));
  return objects;
}

double DistanceToLine(const Vec3d& p, const Ray& line) {
  return Length(Cross(p - line.origin, line.direction));
}

// Every line that meets an object has coordinates, and they give the line back.
void CheckLines(double size, const Vec3d& at, uint64_t seed) {
  test::Random random(seed);
  Scene scene;
  scene.materials.resize(1);
  scene.objects = Objects(random, size, at);
  const Tracer tracer(scene);
  double largest = 0;
  int hits = 0;
  for (int i = 0; i < 40000; ++i) {
    const int k = i % static_cast<int>(scene.objects.size());
    const Object& object = scene.objects[static_cast<size_t>(k)];
    const ObjectChart chart(object);
    Vec3d direction = random.Direction();
    // Ties and directions parallel to the axes are the interesting ones.
    if (i % 3 == 1) direction = Vec3d{1, random.Int(0, 1) ? 1.0 : -1.0, random.Uniform(-1, 1)};
    if (i % 7 == 2) direction[random.Int(0, 2)] = 0;
    if (i % 11 == 3) direction = {0, 0, 1};
    if (Length(direction) == 0) continue;
    const Vec3d target = random.InBox(object.bounds.min, object.bounds.max);
    const Hit hit = tracer.IntersectObjectLine(k, target, direction);
    if (!hit.IsHit()) continue;
    const auto coords = chart.CoordsOf(chart.PairOf(direction), hit.point, direction);
    ASSERT_TRUE(coords.has_value()) << "seed " << seed << ", case " << i << ", object " << k;
    ++hits;
    const Ray line = chart.LineOf(chart.PairOf(direction), *coords);
    ASSERT_GT(Dot(line.direction, direction), 0);
    const double size = Length(object.bounds.Extent());
    const double inset = IsPlanar(object.shape) ? 2 * kRimInset * size : 0;
    const double error =
        std::max(0.0, DistanceToLine(hit.point, line) - inset) / (3 * size + Length(hit.point));
    largest = std::max(largest, error);
    ASSERT_LE(error, kLineRounding) << "seed " << seed << ", case " << i << ", object " << k;
  }
  EXPECT_GT(hits, 10000);
  std::printf("size %g at %g: largest error %.3g of scale, promised %.3g\n", size, at.x, largest,
              kLineRounding);
}

TEST(ObjectChartTest, EveryLineThatMeetsAnObjectHasCoordinates) { CheckLines(1, {0, 0, 0}, 11); }
TEST(ObjectChartTest, AlsoTinyAndHuge) {
  CheckLines(1e-6, {0.3, 0.2, 0.1}, 12);
  CheckLines(1e6, {1, 2, 3}, 13);
}
TEST(ObjectChartTest, AlsoFarFromTheOrigin) { CheckLines(1, {1e6, -1e6, 2e6}, 14); }

// Coordinates may be anything in [0,1]^4: the line always belongs to the pair it was made for.
TEST(ObjectChartTest, LinesOfTheGridKeepTheirPair) {
  test::Random random(15);
  const Object plane = test::ObjectOf(test::Polygon({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}}));
  const ObjectChart chart(plane);
  for (int pair = 0; pair < kFacePairs; ++pair) {
    for (int i = 0; i < 200; ++i) {
      const RayCoords x{random.Uniform(0, 1), random.Uniform(0, 1), random.Uniform(0.01, 0.99),
                        random.Uniform(0.01, 0.99)};
      EXPECT_EQ(chart.PairOf(chart.LineOf(pair, x).direction), pair);
    }
  }
}

TEST(ObjectChartTest, TheExpansionIsAttained) {
  // A ray at 45 degrees through the far edge of the box enters at the very border.
  const ObjectChart chart(test::ObjectOf(test::Box({-1, -1, -1}, {1, 1, 1})));
  const Vec3d direction{1, 1, 0.5};
  const int pair = chart.PairOf(direction);
  EXPECT_EQ(pair, 0) << "ties go to the lowest axis";
  const auto coords = chart.CoordsOf(pair, {1, -1, 0}, direction);
  ASSERT_TRUE(coords);
  EXPECT_NEAR((*coords)[0], 0, 1e-15);
}

// Cells at the rim of a rectangle are as good as those inside.
TEST(ObjectChartTest, CornersOnARectanglesBorderMeetIt) {
  test::Random random(16);
  Scene scene;
  scene.materials.resize(1);
  for (int i = 0; i < 300; ++i) {
    const Vec3d at = random.InBox({-50, -50, -50}, {50, 50, 50});
    const Vec3d u = random.Direction() * random.LogUniform(0.1, 10);
    const Vec3d v = Cross(u, random.Direction());
    if (Length(v) < 0.1) continue;
    scene.objects = {test::ObjectOf(test::Polygon({at, at + u, at + u + v, at + v}))};
    const Tracer tracer(scene);
    const ObjectChart chart(scene.objects[0]);
    for (int corner = 0; corner < 4; ++corner) {
      const Ray line = chart.LineOf(
          4, {static_cast<double>(corner & 1), static_cast<double>(corner / 2), 0.3, 0.8});
      ASSERT_TRUE(tracer.IntersectObjectLine(0, line.origin, line.direction).IsHit()) << i;
    }
  }
}

TEST(ObjectChartTest, RaysAlongAPlanarObjectHaveNoCoordinates) {
  const ObjectChart chart(test::ObjectOf(test::Disc({0, 0, 0}, {0, 0, 1}, 1)));
  const Vec3d direction{1, 0, 0};
  EXPECT_FALSE(chart.CoordsOf(chart.PairOf(direction), {0, 0, 0}, direction));
}

}  // namespace
}  // namespace linetree
