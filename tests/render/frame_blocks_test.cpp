// Frames by packets: with the surface trees' help they are the classical ones, byte by byte at
// epsilon 0 and within epsilon of the scalar tracer's otherwise, whatever the trees hold.
#include "core/render/frame_blocks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/render/scene_host.h"
#include "tests/support/demo_scenes.h"
#include "tests/support/random_scene.h"
#include "tests/support/render_frame.h"
#include "tests/support/sanitizer_share.h"

namespace linetree {
namespace {

FrameRequest Request(const Scene& scene, Mode mode, double epsilon, int size = 96) {
  FrameRequest request;
  request.camera = scene.cameras[0];
  request.width = size;
  request.height = size - 7;  // neither whole blocks nor whole tiles
  request.options.mode = mode;
  request.options.lanes = Lanes::kSimd;
  request.options.max_relative_error = epsilon;
  return request;
}

CacheOptions AlwaysAsk() {
  CacheOptions options;
  options.always_ask = true;
  return options;
}

std::shared_ptr<const Scene> RandomScene(uint64_t seed) {
  test::Random random(seed);
  auto scene =
      std::make_shared<Scene>(test::RandomScene(random, 12 + static_cast<int>(seed % 40), 2));
  scene->cameras = {{"front", {0, -6, 1}, {0, 0, 0}, {0, 0, 1}, 50}};
  return scene;
}

TEST(FrameBlocksTest, AtEpsilonZeroTheyAreClassicalByteByByte) {
  WorkerPool pool(2);
  uint64_t listed = 0, replayed = 0;
  for (uint64_t seed = 0; seed < 40; seed += test::kSanitizerShare) {
    const auto scene = RandomScene(seed);
    SceneHost host(scene, AlwaysAsk());
    const Frame classical = test::RenderFrame(host, Request(*scene, Mode::kClassical, 0), pool);
    for (int repeat = 0; repeat < 3; ++repeat) {
      const Frame cached = test::RenderFrame(host, Request(*scene, Mode::kCached, 0), pool);
      ASSERT_EQ(cached.radiance, classical.radiance) << "scene " << seed;
      ASSERT_EQ(cached.object, classical.object);
      ASSERT_EQ(cached.depth, classical.depth);
      EXPECT_EQ(cached.stats.interpolated, 0u);
      EXPECT_LE(cached.stats.base.shadow, classical.stats.base.shadow);
      EXPECT_EQ(host.surfaces().ByteSize(), host.surfaces().CountBytes());
      listed += cached.stats.base.listed;
      replayed += cached.stats.replayed;
    }
  }
  EXPECT_GT(listed, 100'000u / test::kSanitizerShare);
  EXPECT_GT(replayed, 30'000u / test::kSanitizerShare);
}

TEST(FrameBlocksTest, TheyAreWithinEpsilonOfTheScalarTracer) {
  WorkerPool pool(2);
  uint64_t interpolated = 0;
  double largest = 0;
  for (uint64_t seed = 0; seed < 40; seed += test::kSanitizerShare) {
    auto lit = std::make_shared<Scene>(*RandomScene(seed));
    test::Random random(seed);
    for (int i = 0; i < 6; ++i) {
      lit->lights.push_back(test::PointLight(Vec3d{0, 0, 7} + random.InCube(3)));
      lit->lights.back().irradiance = {0.1, 0.1, 0.1};
    }
    const std::shared_ptr<const Scene> scene = lit;
    FrameRequest reference = Request(*scene, Mode::kClassical, 0);
    reference.options.lanes = Lanes::kScalar;
    SceneHost host(scene, AlwaysAsk());
    const Frame classical = test::RenderFrame(host, reference, pool);
    EXPECT_EQ(classical.lane_rounding, 0);
    for (const double epsilon : {0.25, 0.02, 1e-7}) {
      Frame cached;
      for (int repeat = 0; repeat < 2; ++repeat) {
        cached = test::RenderFrame(host, Request(*scene, Mode::kCached, epsilon), pool);
      }
      const double allowed = epsilon + cached.lane_rounding;
      EXPECT_GT(cached.lane_rounding, 0);
      for (size_t i = 0; i < cached.radiance.size(); ++i) {
        const double truth = std::max<double>(classical.radiance[i], RadianceFloor(*scene));
        const double error = std::abs(static_cast<double>(cached.radiance[i]) -
                                      static_cast<double>(classical.radiance[i]));
        ASSERT_LE(error, truth * (allowed + 0x1p-23))
            << "scene " << seed << ", epsilon " << epsilon;
        largest = std::max(largest, error / truth);
      }
      interpolated += cached.stats.interpolated;
      if (epsilon > 1e-6) continue;
      EXPECT_EQ(cached.stats.interpolated, 0u) << "no room for sums";
    }
  }
  EXPECT_GT(interpolated, 3'000u / test::kSanitizerShare);
  EXPECT_GT(largest, 1e-4) << "sums were used";
}

TEST(FrameBlocksTest, ThreadsChangeNothing) {
  const auto scene = test::BallsOnFloor(12, 80);
  Frame frames[2];
  for (const int threads : {1, 3}) {
    WorkerPool pool(threads);
    SceneHost host(scene, AlwaysAsk());
    Frame& frame = frames[threads == 1 ? 0 : 1];
    for (int repeat = 0; repeat < 3; ++repeat) {
      frame = test::RenderFrame(host, Request(*scene, Mode::kCached, 0.1, 200), pool);
    }
  }
  EXPECT_EQ(frames[0].radiance, frames[1].radiance);
  EXPECT_EQ(frames[0].source, frames[1].source);
  EXPECT_EQ(frames[0].stats.base, frames[1].stats.base);
  EXPECT_EQ(frames[0].stats.cells_tried, frames[1].stats.cells_tried);
}

TEST(FrameBlocksTest, SourcesAddUp) {
  const auto scene = test::BallsOnFloor(12, 81);
  WorkerPool pool(2);
  SceneHost host(scene, AlwaysAsk());
  for (int repeat = 0; repeat < 3; ++repeat) {
    const FrameStats stats =
        test::RenderFrame(host, Request(*scene, Mode::kCached, 0.1, 200), pool).stats;
    EXPECT_EQ(stats.pixels, 200u * 193u);
    EXPECT_EQ(stats.interpolated + stats.traced + stats.background, stats.pixels);
    EXPECT_LE(stats.replayed + stats.residual, stats.traced);
    uint64_t verdicts = 0;
    for (const uint64_t count : stats.verdicts) verdicts += count;
    EXPECT_EQ(verdicts, stats.pixels);
  }
  const FrameStats classical =
      test::RenderFrame(host, Request(*scene, Mode::kClassical, 0, 200), pool).stats;
  EXPECT_EQ(classical.traced + classical.background, classical.pixels);
  EXPECT_EQ(classical.replayed + classical.residual + classical.base.listed, 0u);
}

// The planner leaves trees alone that do not pay: few lights over small clutter.
TEST(FrameBlocksTest, ThePlannerLooksAwayWhereNothingIsToBeSaved) {
  const auto scene = test::BallsOnFloor(300, 82);
  WorkerPool pool(1);
  SceneHost thrifty(scene), lavish(scene, AlwaysAsk());
  const auto cells_of = [&](SceneHost& host) {
    uint64_t cells = 0;
    for (int repeat = 0; repeat < 3; ++repeat) {
      cells +=
          test::RenderFrame(host, Request(*scene, Mode::kCached, 0.1, 200), pool).stats.cells_tried;
    }
    return cells;
  };
  EXPECT_LT(cells_of(thrifty), cells_of(lavish) / 4);
}

// Whether a first frame finds out that trees pay, or that they do not, without tracing anything
// for that alone.
TEST(FrameBlocksTest, FirstFramesSaveWhatTheyCan) {
  auto lit = std::make_shared<Scene>(*test::BallsOnFloor(12, 82));
  for (int i = 0; i < 40; ++i) lit->lights.push_back(test::PointLight({i / 9.0 - 2, -1, 9}));
  const std::shared_ptr<const Scene> scene = lit, clutter = test::BallsOnFloor(300, 82);
  WorkerPool pool(2);
  SceneHost host(scene), searching(clutter);
  const auto next = [&](SceneHost& of) {
    return test::RenderFrame(of, Request(of.scene(), Mode::kCached, 0.1, 400), pool).stats;
  };
  const FrameStats lights = next(host);
  FrameStats later;
  for (int i = 0; i < 3; ++i) later = next(host);
  EXPECT_GT(later.base.summed, later.pixels / 10);
  EXPECT_GT(2 * lights.base.summed, later.base.summed);
  EXPECT_EQ(lights.base.eye, lights.pixels);
  const FrameStats balls = next(searching);
  EXPECT_EQ(balls.base.listed, 0u);
  EXPECT_LT(balls.cells_tried, 12u) << "a trial, no more";
  EXPECT_EQ(balls.base.eye, balls.pixels);
}

TEST(FrameBlocksTest, CancelledBeforeItBegan) {
  const auto scene = test::BallsOnFloor(12, 83);
  WorkerPool pool(2);
  SceneHost host(scene);
  CancelToken cancel;
  cancel.Cancel();
  const auto frame = host.RenderFrame(Request(*scene, Mode::kCached, 0.1), pool, &cancel);
  EXPECT_EQ(frame.status().code(), absl::StatusCode::kCancelled);
}

// What does not fit float goes ray by ray, and says so.
TEST(FrameBlocksTest, ScenesBeyondFloatAreTracedInDouble) {
  auto scene = std::make_shared<Scene>(*test::BallsOnFloor(3, 84));
  scene->lights[0].irradiance = {1e15, 1e15, 1e15};
  WorkerPool pool(1);
  SceneHost host(scene);
  EXPECT_FALSE(host.packets().IsWide());
  const Frame frame = test::RenderFrame(host, Request(*scene, Mode::kClassical, 0), pool);
  EXPECT_EQ(frame.lane_rounding, 0);
}

}  // namespace
}  // namespace linetree
