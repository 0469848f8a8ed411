#include "core/cache/path_cache.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/trace/shade.h"
#include "tests/support/random_scene.h"

namespace linetree {
namespace {

const ParallelLoop kSerial = [](size_t count, const std::function<void(size_t)>& body) {
  for (size_t i = 0; i < count; ++i) body(i);
};

constexpr int kDepth = 8;

// A mirror ball over a matte floor.
Scene MirrorBall() {
  Scene scene;
  scene.background = {0.3, 0.4, 0.5};
  scene.ambient = {0.2, 0.2, 0.2};
  test::AddMaterial(scene, test::Mirror({0.8, 0.8, 0.8}));
  test::AddMaterial(scene, test::Matte({0.5, 0.5, 0.5}));
  test::AddObject(scene, test::Sphere({0, 0, 2}, 1), 0);
  test::AddObject(scene, test::Box({-6, -6, -0.1}, {6, 6, 0}), 1);
  scene.lights.push_back(test::PointLight({3, -5, 8}));
  return scene;
}

class PathCacheTest : public testing::Test {
 protected:
  PathCacheTest() : scene_(MirrorBall()), tracer_(scene_) {}

  // Rays from one eye to the middle of the ball.
  std::vector<Ray> Rays(uint64_t seed, int count) {
    test::Random random(seed);
    std::vector<Ray> rays;
    const Vec3d eye{0, -9, 3};
    for (int i = 0; i < count; ++i) {
      const Vec3d at = random.InBox({-0.4, -1, 1.6}, {0.4, -1, 2.4});
      rays.push_back({eye, Normalized(at - eye)});
    }
    return rays;
  }
  // Looks the rays up; gives back those of which something is known.
  int Use(const PathCache& cache, const std::vector<Ray>& rays, const PathLimits& limits,
          std::vector<PathCache::Sample>* samples) {
    const PathCache::Reader reader(cache, limits, samples);
    int known = 0;
    for (const Ray& ray : rays) {
      const Hit hit = tracer_.Intersect(ray.origin, ray.direction, {});
      if (hit.IsHit() && reader.Find(hit, ray.direction) != nullptr) ++known;
    }
    return known;
  }
  uint64_t Refine(PathCache& cache, uint64_t seed, double weight, double kept_uses = 1) {
    std::vector<PathCache::Sample> samples;
    Use(cache, Rays(seed, 500), {}, &samples);
    return cache.Refine({}, samples, weight, kSerial, /*ahead=*/false, kept_uses);
  }

  Scene scene_;
  Tracer tracer_;
};

TEST_F(PathCacheTest, KnowsNothingUntilItIsRefined) {
  PathCache cache(tracer_, 10'000'000, kDepth);
  EXPECT_EQ(Refine(cache, 1, 100), 0u) << "opens trees for these limits";
  EXPECT_EQ(Refine(cache, 1, 100), 0u) << "plants trees where hits asked for them";
  EXPECT_GT(Refine(cache, 1, 100), 10u);
  EXPECT_GT(Use(cache, Rays(2, 500), {}, nullptr), 400);
}

TEST_F(PathCacheTest, FewRaysAreNotWorthACell) {
  PathCache cache(tracer_, 10'000'000, kDepth);
  for (int i = 0; i < 3; ++i) Refine(cache, 1, 0.01);
  EXPECT_EQ(cache.CellCount(), 0u);
  // But those of many frames are.
  for (int i = 0; i < 20; ++i) Refine(cache, 1, 0.02);
  EXPECT_GT(cache.CellCount(), 0u);
}

TEST_F(PathCacheTest, FewRaysOfEveryFrameAreNotWorthACellEither) {
  PathCache cache(tracer_, 10'000'000, kDepth);
  for (int i = 0; i < 100; ++i) Refine(cache, 1, 0.02, 0.5);
  EXPECT_EQ(cache.CellCount(), 0u);
  EXPECT_EQ(KeptUses(0), 1);
  EXPECT_GT(KeptUses(100), 0.99) << "requests of few rays say little";
  EXPECT_EQ(KeptUses(512 * 512), 0.5);
}

TEST_F(PathCacheTest, OtherLimitsHaveOtherTrees) {
  PathCache cache(tracer_, 10'000'000, kDepth);
  for (uint64_t i = 0; i < 4; ++i) Refine(cache, i, 100);
  const PathLimits other{2, 0.5};
  EXPECT_EQ(Use(cache, Rays(2, 100), other, nullptr), 0);
}

TEST_F(PathCacheTest, WhatCellsSayHolds) {
  PathCache cache(tracer_, 10'000'000, kDepth);
  for (uint64_t i = 0; i < 6; ++i) Refine(cache, i, 1000);
  const PathCache::Reader reader(cache, {}, nullptr);
  int listed = 0, interpolated = 0;
  for (const Ray& ray : Rays(77, 3000)) {
    const Hit hit = tracer_.Intersect(ray.origin, ray.direction, {});
    ASSERT_TRUE(hit.IsHit());
    RayCounts counts;
    const Rgb classical = tracer_.RadianceFromHit(hit, ray.origin, ray.direction, {}, counts);
    Rgb radiance;
    if (reader.Interpolate(hit, ray.direction, 0.05, radiance) == Verdict::kCertified) {
      ++interpolated;
      for (int c = 0; c < 3; ++c) {
        EXPECT_LE(std::abs(radiance[c] - classical[c]), 0.05 * classical[c]);
      }
    }
    const PathStep* step = reader.Find(hit, ray.direction);
    if (step == nullptr || !step->EndsAt(hit) || step->reflected == 0) continue;
    const PathStep& next = step[step->reflected];
    if (!next.listed) continue;
    ++listed;
    const Vec3d away = Reflected(ray.direction, hit.normal);
    const Hit met = tracer_.Intersect(hit.point, away, {hit.object, hit.face, hit.side});
    const auto& among = next.candidates;
    EXPECT_EQ(met.IsHit(), std::find(among.begin(), among.end(), met.object) != among.end());
  }
  EXPECT_GT(listed, 2500);
  EXPECT_GT(interpolated, 500);
}

TEST_F(PathCacheTest, BytesAreExactAndWithinTheBudget) {
  for (const uint64_t budget : {uint64_t{0}, uint64_t{20'000}, uint64_t{200'000}}) {
    PathCache cache(tracer_, budget, kDepth);
    for (uint64_t round = 0; round < 12; ++round) {
      Refine(cache, round, 300);
      ASSERT_EQ(cache.ByteSize(), cache.CountBytes());
      ASSERT_LE(cache.ByteSize(), budget);
    }
    cache.SetMemoryBytes(budget / 4);
    EXPECT_EQ(cache.ByteSize(), cache.CountBytes());
    cache.Clear();
    EXPECT_EQ(cache.ByteSize(), 0u);
    EXPECT_EQ(cache.CellCount(), 0u);
  }
}

TEST_F(PathCacheTest, VerdictsAddUpToCells) {
  PathCache cache(tracer_, 10'000'000, kDepth);
  for (uint64_t i = 0; i < 5; ++i) Refine(cache, i, 100);
  uint64_t sum = 0;
  for (const auto& of_object : cache.CellVerdicts()) {
    for (const uint64_t cells : of_object) sum += cells;
  }
  EXPECT_EQ(sum, cache.CellCount());
}

TEST_F(PathCacheTest, AReaderTakesOnlySoManySamples) {
  PathCache cache(tracer_, 10'000'000, kDepth);
  for (uint64_t i = 0; i < 2; ++i) Refine(cache, i, 100);
  std::vector<PathCache::Sample> samples;
  Use(cache, Rays(1, static_cast<int>(kMaxSamples) + 500), {}, &samples);
  EXPECT_EQ(samples.size(), kMaxSamples);
  Use(cache, Rays(2, 10), {}, &samples);
  EXPECT_EQ(samples.size(), kMaxSamples) << "of another reader into the same store";
}

TEST_F(PathCacheTest, ACancelledRefinementKeepsWhatItBuilt) {
  PathCache cache(tracer_, 10'000'000, kDepth);
  for (uint64_t i = 0; i < 2; ++i) Refine(cache, i, 100);
  std::vector<PathCache::Sample> samples;
  Use(cache, Rays(3, 500), {}, &samples);
  // The loop stops after three cells and runs no body again.
  int left = 3;
  const ParallelLoop cut_short = [&](size_t count, const std::function<void(size_t)>& body) {
    for (size_t i = 0; i < count && left > 0; ++i, --left) body(i);
  };
  const uint64_t before = cache.CellCount();
  const uint64_t certified = cache.Refine({}, samples, 100, cut_short);
  EXPECT_GE(certified, 1u);
  EXPECT_LE(certified, 3u);
  EXPECT_EQ(cache.CellCount(), before + certified);
  EXPECT_EQ(cache.ByteSize(), cache.CountBytes());
  // What was left out comes with the next one.
  EXPECT_GT(Refine(cache, 3, 100), 3u);
}

TEST_F(PathCacheTest, ATinyBudgetDropsWholeTrees) {
  PathCache cache(tracer_, 10'000'000, kDepth);
  for (uint64_t i = 0; i < 6; ++i) Refine(cache, i, 300);
  ASSERT_GT(cache.CellCount(), 20u);
  cache.SetMemoryBytes(200);
  EXPECT_EQ(cache.CellCount(), 0u);
  EXPECT_LE(cache.ByteSize(), 200u);
  EXPECT_EQ(cache.ByteSize(), cache.CountBytes());
  cache.SetMemoryBytes(10'000'000);
  for (uint64_t i = 0; i < 4; ++i) Refine(cache, i, 300);
  EXPECT_GT(cache.CellCount(), 20u);
}

TEST_F(PathCacheTest, OfTooManyLimitsThoseUsedLongestAgoGo) {
  PathCache cache(tracer_, 10'000'000, kDepth);
  const auto limits_of = [](size_t i) { return PathLimits{static_cast<int>(2 + i), 0.01}; };
  const auto learn = [&](const PathLimits& limits) {
    for (uint64_t i = 0; i < 3; ++i) {
      std::vector<PathCache::Sample> samples;
      Use(cache, Rays(i, 300), limits, &samples);
      cache.Refine(limits, samples, 100, kSerial);
    }
  };
  for (size_t i = 0; i < kMaxPathForests; ++i) learn(limits_of(i));
  learn(limits_of(0));  // the oldest is now the second
  learn(limits_of(kMaxPathForests));
  EXPECT_EQ(cache.ByteSize(), cache.CountBytes());
  EXPECT_EQ(Use(cache, Rays(9, 100), limits_of(1), nullptr), 0);
  EXPECT_GT(Use(cache, Rays(9, 100), limits_of(0), nullptr), 50);
  EXPECT_GT(Use(cache, Rays(9, 100), limits_of(kMaxPathForests), nullptr), 50);
}

TEST_F(PathCacheTest, WhatFloatsCannotHoldIsNotInterpolated) {
  scene_.lights[0].irradiance = {1e39, 1e39, 1e39};
  PathCache cache(tracer_, 10'000'000, kDepth);
  for (uint64_t i = 0; i < 5; ++i) Refine(cache, i, 300);
  const PathCache::Reader reader(cache, {}, nullptr);
  int listed = 0;
  for (const Ray& ray : Rays(77, 500)) {
    const Hit hit = tracer_.Intersect(ray.origin, ray.direction, {});
    RayCounts counts;
    const Rgb classical = tracer_.RadianceFromHit(hit, ray.origin, ray.direction, {}, counts);
    if (!(classical.r > std::numeric_limits<float>::max())) continue;  // reflects the sky
    Rgb radiance;
    EXPECT_NE(reader.Interpolate(hit, ray.direction, 1, radiance), Verdict::kCertified);
    listed += reader.Find(hit, ray.direction) != nullptr ? 1 : 0;
  }
  EXPECT_GT(listed, 100) << "where rays go is known all the same";
}

}  // namespace
}  // namespace linetree
