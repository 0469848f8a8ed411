#include "core/render/answer_rays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/render/scene_host.h"
#include "tests/support/demo_scenes.h"
#include "tests/support/render_frame.h"

namespace linetree {
namespace {

FrameRequest Request(const Scene& scene, Mode mode, double epsilon) {
  FrameRequest request;
  request.camera = scene.cameras[0];
  request.width = 128;
  request.height = 128;
  request.options.mode = mode;
  request.options.judge = JudgeKind::kPaper;
  request.options.max_relative_error = epsilon;
  return request;
}

// Pixels beyond epsilon; the paper's judge may have a few, and none where it is certain.
size_t Beyond(const Frame& frame, const Frame& reference, double epsilon, double floor) {
  size_t beyond = 0;
  for (size_t i = 0; i < frame.radiance.size(); ++i) {
    const double a = static_cast<double>(frame.radiance[i]);
    const double b = static_cast<double>(reference.radiance[i]);
    if (std::abs(a - b) > epsilon * std::max(b, floor) * (1 + 1e-6)) ++beyond;
  }
  return beyond;
}

void ExpectCountsAddUp(const FrameStats& stats) {
  EXPECT_EQ(stats.interpolated + stats.traced + stats.background, stats.pixels);
  uint64_t verdicts = 0;
  for (const uint64_t n : stats.verdicts) verdicts += n;
  EXPECT_EQ(verdicts, stats.pixels);
  EXPECT_EQ(stats.verdicts[static_cast<size_t>(Verdict::kCertified)], stats.interpolated);
  EXPECT_EQ(stats.base.eye, stats.pixels);
  EXPECT_EQ(stats.base.intersect,
            stats.base.eye + stats.base.reflected + stats.base.refracted + stats.base.shadow);
  EXPECT_GE(stats.ip.intersect, stats.ip.reflected + stats.ip.refracted + stats.ip.shadow);
  EXPECT_LE(stats.cells_accepted, stats.cells_tried);
}

TEST(AnswerRaysTest, CachedAgreesWithClassicalColdAndWarm) {
  const auto scene = test::BallsOnFloor(5, 60);
  WorkerPool pool(2);
  SceneHost host(scene);
  const Frame classical = test::RenderFrame(host, Request(*scene, Mode::kClassical, 0), pool);
  EXPECT_EQ(classical.stats.interpolated, 0u);
  ExpectCountsAddUp(classical.stats);
  for (const double epsilon : {0.5, 0.1}) {
    SceneHost fresh(scene);
    for (int warm = 0; warm < 2; ++warm) {
      const Frame cached = test::RenderFrame(fresh, Request(*scene, Mode::kCached, epsilon), pool);
      ExpectCountsAddUp(cached.stats);
      EXPECT_GT(cached.stats.interpolated, cached.stats.pixels / 5) << "epsilon " << epsilon;
      EXPECT_LE(Beyond(cached, classical, epsilon, RadianceFloor(*scene)), 5u);
      if (warm == 1) {
        EXPECT_EQ(cached.stats.cells_tried, 0u) << "a warm frame builds nothing new";
      }
    }
  }
}

TEST(AnswerRaysTest, EpsilonZeroIsClassicalBitForBit) {
  const auto scene = test::BallsOnFloor(5, 61);
  WorkerPool pool(2);
  SceneHost host(scene);
  test::RenderFrame(host, Request(*scene, Mode::kCached, 0.5), pool);  // whatever the cache holds
  const Frame classical = test::RenderFrame(host, Request(*scene, Mode::kClassical, 0), pool);
  const Frame cached = test::RenderFrame(host, Request(*scene, Mode::kCached, 0), pool);
  EXPECT_EQ(cached.radiance, classical.radiance);
  EXPECT_EQ(cached.stats.cells_tried, 0u);
}

TEST(AnswerRaysTest, ThreadsChangeNothing) {
  const auto scene = test::BallsOnFloor(40, 62);
  std::vector<Frame> frames;
  for (const int threads : {1, 2, 7}) {
    WorkerPool pool(threads);
    SceneHost host(scene);
    frames.push_back(test::RenderFrame(host, Request(*scene, Mode::kCached, 0.2), pool));
    const Frame& first = frames.front();
    const Frame& frame = frames.back();
    EXPECT_EQ(frame.radiance, first.radiance) << threads << " threads";
    EXPECT_EQ(frame.verdict, first.verdict);
    EXPECT_EQ(frame.stats.base, first.stats.base);
    EXPECT_EQ(frame.stats.ip, first.stats.ip);
    EXPECT_EQ(frame.stats.cells_tried, first.stats.cells_tried);
  }
}

TEST(AnswerRaysTest, ASmallBudgetCostsTimeNotAccuracy) {
  const auto scene = test::BallsOnFloor(5, 63);
  WorkerPool pool(2);
  const Frame classical = [&] {
    SceneHost host(scene);
    return test::RenderFrame(host, Request(*scene, Mode::kClassical, 0), pool);
  }();
  for (const uint64_t budget : {0, 4'000, 100'000, 400'000}) {
    CacheOptions options;
    options.memory_bytes = budget;
    SceneHost host(scene, options);
    for (int i = 0; i < 3; ++i) {
      FrameRequest request = Request(*scene, Mode::kCached, 0.2);
      const Frame frame = test::RenderFrame(host, request, pool);
      EXPECT_LE(frame.stats.cache_bytes, budget);
      EXPECT_LE(Beyond(frame, classical, 0.2, RadianceFloor(*scene)), 5u);
      ExpectCountsAddUp(frame.stats);
    }
  }
}

TEST(AnswerRaysTest, ManyClientsAtOnceStayWithinEpsilon) {
  const auto scene = test::BallsOnFloor(5, 64);
  WorkerPool pool(3);
  CacheOptions options;
  options.memory_bytes = 1'000'000;
  SceneHost host(scene, options);
  const Frame classical = test::RenderFrame(host, Request(*scene, Mode::kClassical, 0), pool);
  std::vector<std::thread> clients;
  for (int c = 0; c < 4; ++c) {
    clients.emplace_back([&, c] {
      const double epsilon = c % 2 == 0 ? 0.4 : 0.05;
      for (int i = 0; i < 3; ++i) {
        const Frame frame = test::RenderFrame(host, Request(*scene, Mode::kCached, epsilon), pool);
        EXPECT_LE(Beyond(frame, classical, epsilon, RadianceFloor(*scene)), 5u);
        ExpectCountsAddUp(frame.stats);
      }
    });
  }
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(host.cache().ByteSize(), host.cache().CountBytes());
}

// An eye inside a closed object and one inside an open cylinder see surfaces that no line from
// outside meets first.
TEST(AnswerRaysTest, EyesInsideObjectsAreServed) {
  auto scene = std::make_shared<Scene>(*test::BallsOnFloor(3, 65));
  scene->objects.push_back(test::ObjectOf(test::Sphere({0, -9, 4}, 20)));
  scene->objects.push_back(test::ObjectOf(test::Frustum({0, -14, 3}, {0, -4, 3}, 3, 3, true)));
  WorkerPool pool(2);
  SceneHost host(scene);
  const Frame classical = test::RenderFrame(host, Request(*scene, Mode::kClassical, 0), pool);
  const Frame cached = test::RenderFrame(host, Request(*scene, Mode::kCached, 0.1), pool);
  EXPECT_LE(Beyond(cached, classical, 0.1, RadianceFloor(*scene)), 5u);
}

}  // namespace
}  // namespace linetree
