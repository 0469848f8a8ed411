// The certified judge: every answer is within epsilon of the classical one, and at epsilon 0 the
// classical one, bit for bit, whatever the cache holds.
#include <gtest/gtest.h>

#include <thread>

#include "core/render/scene_host.h"
#include "tests/support/demo_scenes.h"
#include "tests/support/random_scene.h"
#include "tests/support/render_frame.h"
#include "tests/support/sanitizer_share.h"

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

TEST(CertifiedTest, ColdWarmAndEvictedFramesAreClassicalBitForBit) {
  const auto scene = test::BallsOnFloor(12, 80);
  WorkerPool pool(2);
  for (const uint64_t budget : {uint64_t{0}, uint64_t{60'000}, uint64_t{64} << 20}) {
    CacheOptions options;
    options.memory_bytes = budget;
    SceneHost host(scene, options);
    const Frame classical = test::RenderFrame(host, Request(*scene, Mode::kClassical), pool);
    for (int repeat = 0; repeat < 3; ++repeat) {
      const Frame cached = test::RenderFrame(host, Request(*scene, Mode::kCached), pool);
      ASSERT_EQ(cached.radiance, classical.radiance) << "budget " << budget;
      EXPECT_LE(cached.stats.cache_bytes, budget);
      EXPECT_EQ(host.surfaces().ByteSize(), host.surfaces().CountBytes());
      EXPECT_EQ(cached.stats.base.shadow, classical.stats.base.shadow);
      EXPECT_EQ(host.paths().ByteSize(), host.paths().CountBytes());
      const RayCounts& counts = cached.stats.base;
      EXPECT_EQ(counts.intersect + counts.listed + counts.listed_branches,
                classical.stats.base.intersect);
      EXPECT_EQ(cached.stats.interpolated, 0u);
    }
  }
}

TEST(CertifiedTest, AWarmFrameSearchesTheSceneMuchLess) {
  const auto scene = test::BallsOnFloor(12, 81);
  WorkerPool pool(2);
  SceneHost host(scene);
  const Frame classical = test::RenderFrame(host, Request(*scene, Mode::kClassical, 256), pool);
  test::RenderFrame(host, Request(*scene, Mode::kCached, 256), pool);
  const Frame warm = test::RenderFrame(host, Request(*scene, Mode::kCached, 256), pool);
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

// Both lanes and both judges.
TEST(CertifiedTest, CancelledFramesKeepTheCellsThatAreDone) {
  WorkerPool pool(2);
  const auto scene = CrowdedScene(2);
  for (const auto& [lanes, judge] : {std::pair(Lanes::kScalar, JudgeKind::kCertified),
                                     {Lanes::kSimd, JudgeKind::kCertified},
                                     {Lanes::kScalar, JudgeKind::kPaper}}) {
    SceneHost host(scene, {.always_ask = true});
    FrameRequest request = Request(*scene, Mode::kCached, 512);
    request.height = 600;  // several batches of rays, several slices of blocks
    request.options.lanes = lanes;
    request.options.judge = judge;
    request.options.max_relative_error = 0.1;
    CancelToken cancel;
    const auto frame = host.RenderFrame(request, pool, &cancel, [&](double share) {
      EXPECT_LT(share, 1);
      if (share >= 0.9) cancel.Cancel();
    });
    EXPECT_TRUE(absl::IsCancelled(frame.status()));
    EXPECT_EQ(host.totals().frames, 0u);
    const uint64_t cells =
        host.cache().CellCount() + host.paths().CellCount() + host.surfaces().CellCount();
    EXPECT_GT(cells, 0u);
    EXPECT_EQ(host.cache().ByteSize(), host.cache().CountBytes());
    if (judge == JudgeKind::kPaper) continue;
    request.width = request.height = 96;
    request.options.max_relative_error = 0;
    const Frame warm = test::RenderFrame(host, request, pool);
    request.options.mode = Mode::kClassical;
    EXPECT_EQ(warm.radiance, test::RenderFrame(host, request, pool).radiance);
  }
}

TEST(CertifiedTest, RandomScenesAreClassicalBitForBit) {
  WorkerPool pool(2);
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    const auto scene = CrowdedScene(seed);
    SceneHost host(scene);
    const Frame classical = test::RenderFrame(host, Request(*scene, Mode::kClassical, 128), pool);
    for (int repeat = 0; repeat < 2; ++repeat) {
      const Frame cached = test::RenderFrame(host, Request(*scene, Mode::kCached, 128), pool);
      ASSERT_EQ(cached.radiance, classical.radiance) << "seed " << seed;
    }
    EXPECT_GT(host.surfaces().CellCount(), 10u) << "seed " << seed;
  }
}

// Mirrors and glass of all shapes, apart from each other, so that there is something to
// interpolate.
std::shared_ptr<const Scene> MirrorsAndGlass(uint64_t seed) {
  test::Random random(seed);
  auto scene = std::make_shared<Scene>();
  scene->ambient = {1, 1, 1};
  scene->background = {0.3, 0.4, 0.5};
  for (int i = 0; i < 9; ++i) {
    Material material = test::RandomMaterial(random);
    material.ambient = {0.1, 0.1, 0.1};
    if (i % 3 == 0) material.transmit = {0.7, 0.8, 0.6}, material.ior = random.Uniform(1.1, 1.7);
    if (i % 3 != 0) material.transmit = {};
    material.reflect = {0.3, 0.2, 0.4};
    test::AddMaterial(*scene, material);
    const auto kind = test::kShapeKinds[static_cast<size_t>(
        random.Below(static_cast<int>(test::kShapeKinds.size())))];
    const Vec3d center{3.0 * (i % 3 - 1), 3.0 * (i / 3 - 1), random.Uniform(-0.5, 0.5)};
    test::AddObject(*scene, test::RandomShape(kind, random, 1, center), i);
  }
  scene->lights.push_back(test::PointLight(random.Direction() * 12, {0.8, 0.7, 0.9}));
  Camera camera;
  camera.eye = Vec3d{1, -2, 9} + random.Direction();
  camera.look_at = {};
  camera.up = {0, 1, 0};
  scene->cameras = {camera};
  return scene;
}

TEST(CertifiedTest, InterpolatedFramesAreWithinEpsilon) {
  WorkerPool pool(2);
  uint64_t interpolated = 0, listed = 0;
  for (uint64_t seed = 1; seed <= 8 / test::kSanitizerShare; ++seed) {
    const auto scene = MirrorsAndGlass(seed);
    SceneHost host(scene);
    const Frame classical = test::RenderFrame(host, Request(*scene, Mode::kClassical, 256), pool);
    for (const double epsilon : {0.1, 0.1, 0.02, 0.0, 0.25}) {
      FrameRequest request = Request(*scene, Mode::kCached, 256);
      request.options.max_relative_error = epsilon;
      const Frame cached = test::RenderFrame(host, request, pool);
      interpolated += cached.stats.interpolated;
      listed += cached.stats.base.listed_branches;
      for (size_t i = 0; i < cached.radiance.size(); ++i) {
        const double allowed = std::max<double>(classical.radiance[i], RadianceFloor(*scene));
        // Frames hold floats.
        const double rounding = epsilon > 0 ? (1 + epsilon) * 0x1p-23 : 0;
        ASSERT_LE(std::abs(cached.radiance[i] - classical.radiance[i]),
                  (epsilon + rounding) * allowed)
            << "seed " << seed << " epsilon " << epsilon << " channel " << i;
      }
    }
  }
  EXPECT_GT(interpolated, 2000u / test::kSanitizerShare);
  EXPECT_GT(listed, 20000u / test::kSanitizerShare);
}

// What frames learn they learn for all: many at a time divide cells no further than one after the
// other. Which cells there are depends on who comes first, but not by much.
TEST(CertifiedTest, FramesAtTheSameTimeBuildAboutWhatFramesInTurnDo) {
  const auto scene = test::BallsOnFloor(12, 82);
  constexpr int kClients = 4, kFrames = 6;
  const auto cells_of = [&](bool at_the_same_time) {
    WorkerPool pool(2);
    SceneHost host(scene);
    const auto fly = [&] {
      for (int frame = 0; frame < kFrames; ++frame) {
        test::RenderFrame(host, Request(*scene, Mode::kCached, 128), pool);
      }
    };
    std::vector<std::thread> clients;
    for (int c = 0; c < kClients; ++c) {
      clients.emplace_back(fly);
      if (!at_the_same_time) clients.back().join();
    }
    for (std::thread& client : clients) {
      if (client.joinable()) client.join();
    }
    return host.surfaces().CellCount();
  };
  const uint64_t in_turn = cells_of(false), together = cells_of(true);
  EXPECT_GT(in_turn, 100u);
  EXPECT_LE(together, 2 * in_turn);
}

TEST(CertifiedTest, ThreadsAndClientsChangeNothing) {
  const auto scene = test::BallsOnFloor(12, 82);
  CacheOptions options;
  options.memory_bytes = 400'000;
  SceneHost host(scene, options);
  WorkerPool pool(3);
  const Frame classical = test::RenderFrame(host, Request(*scene, Mode::kClassical), pool);
  std::vector<std::thread> clients;
  for (int c = 0; c < 4; ++c) {
    clients.emplace_back([&] {
      for (int i = 0; i < 4; ++i) {
        const Frame cached = test::RenderFrame(host, Request(*scene, Mode::kCached), pool);
        EXPECT_EQ(cached.radiance, classical.radiance);
      }
    });
  }
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(host.surfaces().ByteSize(), host.surfaces().CountBytes());
}

}  // namespace
}  // namespace linetree
