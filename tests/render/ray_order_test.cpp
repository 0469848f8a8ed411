#include "core/render/ray_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "tests/support/demo_scenes.h"

namespace linetree {
namespace {

constexpr Box3 kBounds{{-1, -1, -1}, {1, 1, 1}};

std::vector<Ray> RandomRays(size_t count) {
  test::Random random(1);
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) ray = {random.InCube(1), random.Direction()};
  return rays;
}

// Of rays that follow each other.
double MeanDistance(const std::vector<Ray>& rays, const std::vector<uint32_t>& order) {
  double sum = 0;
  for (size_t i = 1; i < order.size(); ++i) {
    const Ray &a = rays[order[i - 1]], &b = rays[order[i]];
    sum += Length(a.origin - b.origin) + Length(a.direction - b.direction);
  }
  return sum / static_cast<double>(order.size() - 1);
}

TEST(RayOrderTest, SortedRaysAreAllOfThemAndNeighboursAreNear) {
  const std::vector<Ray> rays = RandomRays(20'000);
  const std::vector<uint32_t> order = SortedRays(rays, kBounds);
  std::vector<uint32_t> all = order;
  std::sort(all.begin(), all.end());
  ASSERT_EQ(all.size(), rays.size());
  for (uint32_t i = 0; i < all.size(); ++i) ASSERT_EQ(all[i], i);
  EXPECT_LT(MeanDistance(rays, order), 0.3 * MeanDistance(rays, all));
}

TEST(RayOrderTest, RaysOutsideTheBoundsAreSortedToo) {
  std::vector<Ray> rays = RandomRays(100);
  for (size_t i = 0; i < rays.size(); i += 2) rays[i].origin = rays[i].origin * 1e300;
  EXPECT_EQ(SortedRays(rays, kBounds).size(), rays.size());
  EXPECT_EQ(SortedRays(rays, Box3{{0, 0, 0}, {0, 0, 0}}).size(), rays.size());
  EXPECT_TRUE(SortedRays({}, kBounds).empty());
}

TEST(RayOrderTest, EqualRaysStayInOrder) {
  const std::vector<Ray> rays(500, Ray{{0.1, 0.2, 0.3}, {0, 0, 1}});
  const std::vector<uint32_t> order = SortedRays(rays, kBounds);
  EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
}

TEST(RayOrderTest, HitsAreBinnedByObjectThenFaceAndMissesAreLeftOut) {
  const auto scene = test::BallsOnFloor(6, 2);
  test::Random random(3);
  std::vector<Hit> hits(5000);
  size_t misses = 0;
  for (Hit& hit : hits) {
    if (random.Below(4) == 0) {
      ++misses;
      continue;
    }
    hit.object = random.Below(static_cast<int>(scene->objects.size()));
    hit.face = random.Below(3);
    const Box3& bounds = scene->objects[static_cast<size_t>(hit.object)].bounds;
    for (int i = 0; i < 3; ++i) hit.point[i] = random.Uniform(bounds.min[i], bounds.max[i]);
  }
  const std::vector<uint32_t> order = BinnedHits(*scene, hits);
  ASSERT_EQ(order.size(), hits.size() - misses);
  std::vector<uint32_t> unique = order;
  std::sort(unique.begin(), unique.end());
  EXPECT_EQ(std::adjacent_find(unique.begin(), unique.end()), unique.end());
  double distance = 0;
  for (size_t i = 1; i < order.size(); ++i) {
    const Hit &a = hits[order[i - 1]], &b = hits[order[i]];
    ASSERT_LE(std::tie(a.object, a.face), std::tie(b.object, b.face));
    const double size = Length(scene->objects[static_cast<size_t>(a.object)].bounds.Extent());
    if (a.object == b.object) distance += Length(a.point - b.point) / size;
  }
  EXPECT_LT(distance / static_cast<double>(order.size()), 0.25);
}

TEST(RayOrderTest, EyeRaysKeepTogetherAndRandomOnesDoNot) {
  const auto scene = test::BallsOnFloor(6, 4);
  const EyeRays eye_rays(scene->cameras[0], 64, 64);
  std::vector<Ray> rays;
  for (int i = 0; i < 64 * 64; ++i) rays.push_back(eye_rays.ThroughPixel(i % 64, i / 64));
  EXPECT_TRUE(KeepTogether(rays, scene->WorldBounds()));
  EXPECT_FALSE(KeepTogether(RandomRays(1000), kBounds));
  std::vector<Ray> apart(1000, Ray{{0, 0, 0}, {0, 0, 1}});
  EXPECT_TRUE(KeepTogether(apart, kBounds));
  for (size_t i = 0; i < apart.size(); i += 2) apart[i].origin.x = 0.9;
  EXPECT_FALSE(KeepTogether(apart, kBounds));
  EXPECT_TRUE(KeepTogether(RandomRays(15), kBounds)) << "less than a packet";
}

}  // namespace
}  // namespace linetree
