// A cache of surfaces that is full: it goes on learning what is new, in the place of what is old.
#include <gtest/gtest.h>

#include "core/cache/surface_cache.h"
#include "tests/support/demo_scenes.h"

namespace linetree {
namespace {

const ParallelLoop kInTurn = [](size_t count, const std::function<void(size_t)>& body) {
  for (size_t i = 0; i < count; ++i) body(i);
};

class FullCacheTest : public testing::TestWithParam<uint64_t> {
 protected:
  FullCacheTest() : scene_(test::BallsOnFloor(12, 90)), tracer_(*scene_) {}

  // A frame that sees what lies between two x; returns how many cells it built.
  uint64_t Fly(SurfaceCache& cache, double from, double to, uint64_t seed) {
    test::Random random(seed);
    {
      const SurfaceCache::Reader reader(cache, 0);
      for (int i = 0; i < 400; ++i) {
        const Vec3d eye = {0.5 * (from + to), -9, 4};
        const Vec3d at = random.InBox({from, -3, 0}, {to, 4, 2});
        const Hit hit = tracer_.Intersect(eye, at - eye, {});
        if (hit.IsHit()) reader.Find(hit);
      }
    }
    const uint64_t built = cache.Refine(100, kInTurn);
    cache.EndFrame({});
    EXPECT_LE(cache.ByteSize(), GetParam());
    return built;
  }

  std::shared_ptr<const Scene> scene_;
  Tracer tracer_;
};

TEST_P(FullCacheTest, WhatIsNewFindsRoom) {
  SurfaceCache cache(tracer_, GetParam());
  cache.SetPolicy("reuse");
  for (uint64_t frame = 0; frame < 12; ++frame) Fly(cache, -4, -0.5, frame);
  ASSERT_GT(cache.CellCount(), 0u);
  uint64_t built = 0;
  for (uint64_t frame = 0; frame < 12; ++frame) built += Fly(cache, 0.5, 4, 100 + frame);
  EXPECT_GT(built, cache.CellCount() / 4);
}

INSTANTIATE_TEST_SUITE_P(Bytes, FullCacheTest,
                         testing::Values(16'000, 24'000, 36'000, 60'000, 100'000),
                         [](const auto& of) { return std::to_string(of.param); });

}  // namespace
}  // namespace linetree
