#include "core/audit/query_rays.h"

#include <gtest/gtest.h>

#include "core/audit/scene_families.h"

namespace linetree {
namespace {

using Make = Ray (QueryRays::*)(RandomStream&) const;

// Of so many rays, those that meet an object.
int CountHits(const Scene& scene, Make make, uint64_t seed, int rays) {
  const Tracer tracer(scene);
  const QueryRays source(tracer, scene.cameras);
  RandomStream random(seed), again(seed);
  int hits = 0;
  for (int i = 0; i < rays; ++i) {
    const Ray ray = (source.*make)(random);
    const Ray same = (source.*make)(again);
    EXPECT_EQ(ray.origin, same.origin);
    EXPECT_EQ(ray.direction, same.direction);
    EXPECT_TRUE(IsFinite(ray.origin));
    EXPECT_NEAR(Length(ray.direction), 1, 1e-12);
    hits += tracer.Intersect(ray.origin, ray.direction, RayStart{}).IsHit();
  }
  return hits;
}

TEST(QueryRaysTest, AreUnitReproducibleAndMostlyMeetSomething) {
  constexpr int kRays = 2000;
  for (int family = 0; family < kSceneFamilies; ++family) {
    const auto scene = MakeFamilyScene(static_cast<SceneFamily>(family), 3);
    SCOPED_TRACE(scene->name);
    EXPECT_GT(CountHits(*scene, &QueryRays::Random, 5, kRays), kRays / 10);
    EXPECT_GT(CountHits(*scene, &QueryRays::Lattice, 6, kRays), kRays / 4);
  }
}

TEST(QueryRaysTest, NearRaysAreNear) {
  const auto scene = MakeFamilyScene(SceneFamily::kWalls, 1);
  const Tracer tracer(*scene);
  const QueryRays source(tracer, scene->cameras);
  RandomStream random(9);
  const double size = Length(scene->WorldBounds().Extent());
  for (const double step : {1e-7, 1e-3, 0.1}) {
    for (int i = 0; i < 200; ++i) {
      const Ray ray = source.Random(random);
      const Ray near = source.Near(ray, step, random);
      EXPECT_LE(Length(near.origin - ray.origin), step * size * (1 + 1e-9));
      EXPECT_NEAR(Length(near.direction), 1, 1e-12);
    }
  }
}

TEST(QueryRaysTest, AnEmptySceneHasRaysToo) {
  Scene scene;
  scene.cameras.emplace_back();
  EXPECT_EQ(CountHits(scene, &QueryRays::Random, 1, 20), 0);
  EXPECT_EQ(CountHits(scene, &QueryRays::Lattice, 1, 20), 0);
}

}  // namespace
}  // namespace linetree
