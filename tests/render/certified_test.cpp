// The certified judge: every answer is the classical one, bit for bit, whatever the cache holds.
#include <gtest/gtest.h>

#include <thread>

#include "core/render/scene_host.h"
#include "tests/support/demo_scenes.h"
#include "tests/support/random_scene.h"

namespace linetree {
namespace {

FrameRequest Request(const Scene& scene, Mode mode, int size = 96) {
  FrameRequest request;
  request.camera = scene.cameras[0];
  request.width = request.height = size;
  request.options.mode = mode;
  request.options.judge = JudgeKind::kCertified;
  request.options.max_relative_error = 0;
  return request;
}

Frame Render(SceneHost& host, const FrameRequest& request, WorkerPool& pool) {
  auto frame = host.RenderFrame(request, pool);
  EXPECT_TRUE(frame.ok()) << frame.status();
  return *std::move(frame);
}

TEST(CertifiedTest, ColdWarmAndEvictedFramesAreClassicalBitForBit) {
  const auto scene = test::BallsOnFloor(12, 80);
  WorkerPool pool(2);
  for (const uint64_t budget : {uint64_t{0}, uint64_t{60'000}, uint64_t{64} << 20}) {
    CacheOptions options;
    options.memory_bytes = budget;
    SceneHost host(scene, options);
    const Frame classical = Render(host, Request(*scene, Mode::kClassical), pool);
    for (int repeat = 0; repeat < 3; ++repeat) {
      const Frame cached = Render(host, Request(*scene, Mode::kCached), pool);
      ASSERT_EQ(cached.radiance, classical.radiance) << "budget " << budget;
      EXPECT_LE(cached.stats.cache_bytes, budget);
      EXPECT_EQ(host.surfaces().ByteSize(), host.surfaces().CountBytes());
      EXPECT_EQ(cached.stats.base.shadow, classical.stats.base.shadow);
      EXPECT_EQ(cached.stats.base.intersect + cached.stats.base.listed,
                classical.stats.base.intersect);
    }
  }
}

TEST(CertifiedTest, AWarmFrameSearchesTheSceneMuchLess) {
  const auto scene = test::BallsOnFloor(12, 81);
  WorkerPool pool(2);
  SceneHost host(scene);
  const Frame classical = Render(host, Request(*scene, Mode::kClassical, 256), pool);
  Render(host, Request(*scene, Mode::kCached, 256), pool);
  const Frame warm = Render(host, Request(*scene, Mode::kCached, 256), pool);
  EXPECT_EQ(warm.radiance, classical.radiance);
  EXPECT_GT(warm.stats.base.listed, warm.stats.base.shadow * 9 / 10);
  EXPECT_LT(warm.stats.base.intersect, classical.stats.base.intersect / 2);
}

// All shapes, materials and lights that there are, in each other's way at random.
std::shared_ptr<const Scene> CrowdedScene(uint64_t seed) {
  test::Random random(seed);
  const int count = seed % 2 == 0 ? 22 : 60;  // with and without a hierarchy
  auto scene = std::make_shared<Scene>(test::RandomScene(random, count, 3));
  Camera camera;
  camera.eye = random.Direction() * 8;
  camera.up = random.Direction();
  scene->cameras = {camera};
  return scene;
}

TEST(CertifiedTest, RandomScenesAreClassicalBitForBit) {
  WorkerPool pool(2);
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    const auto scene = CrowdedScene(seed);
    SceneHost host(scene);
    const Frame classical = Render(host, Request(*scene, Mode::kClassical, 128), pool);
    for (int repeat = 0; repeat < 2; ++repeat) {
      const Frame cached = Render(host, Request(*scene, Mode::kCached, 128), pool);
      ASSERT_EQ(cached.radiance, classical.radiance) << "seed " << seed;
    }
    EXPECT_GT(host.surfaces().CellCount(), 10u) << "seed " << seed;
  }
}

TEST(CertifiedTest, ThreadsAndClientsChangeNothing) {
  const auto scene = test::BallsOnFloor(12, 82);
  CacheOptions options;
  options.memory_bytes = 400'000;
  SceneHost host(scene, options);
  WorkerPool pool(3);
  const Frame classical = Render(host, Request(*scene, Mode::kClassical), pool);
  std::vector<std::thread> clients;
  for (int c = 0; c < 4; ++c) {
    clients.emplace_back([&] {
      for (int i = 0; i < 4; ++i) {
        const Frame cached = Render(host, Request(*scene, Mode::kCached), pool);
        EXPECT_EQ(cached.radiance, classical.radiance);
      }
    });
  }
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(host.surfaces().ByteSize(), host.surfaces().CountBytes());
}

}  // namespace
}  // namespace linetree
