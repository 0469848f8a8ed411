#include "core/render/scene_host.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <thread>

#include "tests/support/demo_scenes.h"

namespace linetree {
namespace {

using testing::HasSubstr;

class SceneHostTest : public testing::Test {
 protected:
  SceneHostTest() : host_(test::BallsOnFloor(3, 70)), pool_(2) {
    request_.camera = host_.scene().cameras[0];
    request_.width = 40;
    request_.height = 30;
  }
  std::string ErrorOf(const FrameRequest& request) {
    return std::string(host_.RenderFrame(request, pool_).status().message());
  }

  SceneHost host_;
  WorkerPool pool_;
  FrameRequest request_;
};

TEST_F(SceneHostTest, RefusesBadRequestsByField) {
  FrameRequest bad = request_;
  bad.camera.eye.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(ErrorOf(bad), HasSubstr("camera.eye"));
  bad = request_;
  bad.width = 0;
  EXPECT_THAT(ErrorOf(bad), HasSubstr("width"));
  bad = request_;
  bad.options.max_relative_error = 2;
  EXPECT_THAT(ErrorOf(bad), HasSubstr("max_relative_error"));
  EXPECT_EQ(host_.totals().frames, 0u);
}

TEST_F(SceneHostTest, BothKindsOfLanesGiveOnePicture) {
  request_.options.mode = Mode::kClassical;
  const auto scalar = host_.RenderFrame(request_, pool_);
  request_.options.lanes = Lanes::kSimd;
  const auto simd = host_.RenderFrame(request_, pool_);
  ASSERT_TRUE(scalar.ok() && simd.ok());
  EXPECT_EQ(simd->object, scalar->object);
  EXPECT_EQ(simd->depth, scalar->depth);
  EXPECT_EQ(simd->source, scalar->source);
  EXPECT_EQ(simd->stats.base, scalar->stats.base);
  EXPECT_EQ(simd->stats.pixels, scalar->stats.pixels);
  EXPECT_EQ(simd->stats.traced, scalar->stats.traced);
  EXPECT_EQ(simd->stats.background, scalar->stats.background);
  EXPECT_EQ(simd->stats.verdicts, scalar->stats.verdicts);
  const double floor = RadianceFloor(host_.scene());
  for (size_t i = 0; i < scalar->radiance.size(); ++i) {
    const double classical = scalar->radiance[i];
    EXPECT_NEAR(simd->radiance[i], classical,
                PacketRadianceRounding(20) * std::max(classical, floor));
  }
}

TEST_F(SceneHostTest, CancelStopsWideFrames) {
  request_.options.mode = Mode::kClassical;
  request_.options.lanes = Lanes::kSimd;
  CancelToken cancel;
  cancel.Cancel();
  EXPECT_TRUE(absl::IsCancelled(host_.RenderFrame(request_, pool_, &cancel).status()));
}

TEST_F(SceneHostTest, MemoryIsReportedByPart) {
  const auto bytes_of = [&](std::string_view name) -> uint64_t {
    for (const MemoryPart& part : host_.Memory()) {
      if (part.name == name) return part.bytes;
    }
    ADD_FAILURE() << name;
    return 0;
  };
  EXPECT_EQ(bytes_of("packets"), 0u);
  request_.options.lanes = Lanes::kSimd;
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(host_.RenderFrame(request_, pool_).ok());
  EXPECT_EQ(bytes_of("packets"), host_.packets().ByteSize());
  request_.options.lanes = Lanes::kScalar;
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(host_.RenderFrame(request_, pool_).ok());
  uint64_t budgeted = 0;
  for (const MemoryPart& part : host_.Memory()) {
    if (part.has_cells) budgeted += part.bytes;
  }
  EXPECT_EQ(budgeted, host_.CacheBytes());
  EXPECT_GT(bytes_of("surface trees"), 0u);
  EXPECT_GT(bytes_of("planner"), 0u);
}

TEST_F(SceneHostTest, ExplainsEveryObject) {
  EXPECT_EQ(host_.Explain(0.1).decisions, 0u);
  request_.width = request_.height = 192;  // a tile of every 32 x 32 pixels is looked at
  request_.options.lanes = Lanes::kSimd;
  const auto frame = host_.RenderFrame(request_, pool_);
  ASSERT_TRUE(frame.ok());
  EXPECT_GT(frame->stages.probe_ms, 0);
  const SceneHost::Explanation explanation = host_.Explain(0.1);
  EXPECT_GE(explanation.decisions, 1u);
  ASSERT_EQ(explanation.objects.size(), host_.scene().objects.size());
  uint32_t points = 0;
  for (const ObjectPlan& object : explanation.objects) points += object.points;
  EXPECT_GT(points, 0u);
}

TEST_F(SceneHostTest, RaysAndFramesAgree) {
  request_.options.max_relative_error = 0;
  const auto frame = host_.RenderFrame(request_, pool_);
  ASSERT_TRUE(frame.ok());
  const EyeRays eye(request_.camera, request_.width, request_.height);
  std::vector<Ray> rays;
  for (int y = 0; y < request_.height; ++y) {
    for (int x = 0; x < request_.width; ++x) {
      rays.push_back(eye.ThroughPixel(x, y));
      rays.back().direction = rays.back().direction * 1.0;
    }
  }
  const auto batch = host_.TraceRays(rays, request_.options, pool_);
  ASSERT_TRUE(batch.ok());
  for (size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(batch->answers[i].object, frame->object[i]);
    ASSERT_NEAR(batch->answers[i].radiance.g, static_cast<double>(frame->radiance[3 * i + 1]),
                1e-6);
  }
  EXPECT_EQ(host_.totals().frames, 1u);
  EXPECT_EQ(host_.totals().ray_batches, 1u);
  EXPECT_EQ(host_.totals().stats.pixels, 2 * rays.size());
}

TEST_F(SceneHostTest, DirectionsOfAnyLengthAreTaken) {
  const Vec3d from{0, -9, 4}, to{0, 0, 0.1};
  for (const double scale : {1e-300, 1e-5, 1.0, 1e300}) {
    const auto batch = host_.TraceRays({{from, (to - from) * scale}}, {}, pool_);
    ASSERT_TRUE(batch.ok()) << batch.status();
    EXPECT_NE(batch->answers[0].object, kNoObject);
    EXPECT_NEAR(batch->answers[0].depth, 9.6, 2);
  }
}

TEST_F(SceneHostTest, RefusesBadRaysByIndex) {
  const double inf = std::numeric_limits<double>::infinity();
  const Ray good{{0, 0, 5}, {0, 0, -1}};
  for (const Ray& bad : {Ray{{0, inf, 0}, {0, 0, 1}}, Ray{{0, 0, 0}, {0, 0, 0}},
                         Ray{{0, 0, 0}, {std::nan(""), 0, 1}}}) {
    const auto status = host_.TraceRays({good, bad}, {}, pool_).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(status.message()), HasSubstr("rays[1]."));
  }
  const std::vector<Ray> many((size_t{1} << 20) + 1, good);
  EXPECT_EQ(host_.TraceRays(many, {}, pool_).status().code(), absl::StatusCode::kResourceExhausted);
}

TEST_F(SceneHostTest, CancelledRequestsStopAndKeepTheHostAlive) {
  CancelToken cancel;
  cancel.Cancel();
  EXPECT_EQ(host_.RenderFrame(request_, pool_, &cancel).status().code(),
            absl::StatusCode::kCancelled);
  EXPECT_TRUE(host_.RenderFrame(request_, pool_).ok());
}

TEST_F(SceneHostTest, ProgressRunsFromZeroToOne) {
  double last = 0;
  ASSERT_TRUE(host_
                  .RenderFrame(request_, pool_, nullptr,
                               [&](double share) {
                                 EXPECT_GE(share, last);
                                 last = share;
                               })
                  .ok());
  EXPECT_EQ(last, 1);
}

TEST_F(SceneHostTest, AnEmptySceneIsAllBackground) {
  auto scene = std::make_shared<Scene>();
  scene->background = {0.25, 0.5, 0.75};
  SceneHost host(scene);
  const auto frame = host.RenderFrame(request_, pool_);
  ASSERT_TRUE(frame.ok());
  EXPECT_EQ(frame->stats.background, frame->stats.pixels);
  EXPECT_EQ(frame->radiance[1], 0.5f);
}

// Three sessions whose cells find no room, while the policy changes.
TEST(SceneHostEvictionTest, WhatIsKeptChangesNoAnswer) {
  const auto scene = test::BallsOnFloor(8, 70);
  constexpr uint64_t kBudget = 120'000;  // surface trees alone would take as much
  SceneHost host(scene, {.memory_bytes = kBudget, .always_ask = true});
  WorkerPool pool(2);
  const auto render = [&](int view, Mode mode) {
    FrameRequest request;
    request.camera = scene->cameras[0];
    request.camera.eye.x += view;
    request.width = request.height = 96;
    request.options.mode = mode;
    request.options.max_relative_error = 0;
    auto frame = host.RenderFrame(request, pool);
    EXPECT_TRUE(frame.ok()) << frame.status();
    return frame.ok() ? frame->radiance : PixelLayer<float>();
  };
  std::vector<std::thread> sessions;
  for (int view = 0; view < 3; ++view) {
    sessions.emplace_back([&, view] {
      const PixelLayer<float> classical = render(view, Mode::kClassical);
      for (int i = 0; i < 8; ++i) EXPECT_EQ(render(view, Mode::kCached), classical) << view;
    });
  }
  for (const PolicyNote& note : AllPolicies()) {
    EXPECT_TRUE(host.SetPolicy(std::string(note.name)).ok());
    EXPECT_LE(host.CacheBytes(), kBudget);
    render(4, Mode::kCached);
  }
  for (std::thread& session : sessions) session.join();
  // What the sessions had time to evict depends on who came first; other views take the rest.
  for (int view = 5; view < 30 && host.surfaces().evicted().cells == 0; ++view) {
    render(view, Mode::kCached);
  }
  EXPECT_GT(host.surfaces().evicted().cells, 0u);
  EXPECT_GT(host.paths().evicted().cells, 0u);
  EXPECT_EQ(host.evicted().cells, host.surfaces().evicted().cells + host.paths().evicted().cells);
  EXPECT_EQ(host.surfaces().CountBytes(), host.surfaces().ByteSize());
  EXPECT_EQ(host.paths().CountBytes(), host.paths().ByteSize());
  EXPECT_FALSE(host.SetPolicy("mru").ok());
  EXPECT_EQ(host.policy(), AllPolicies().back().name);
}

// Frames of a cache that is too small do without it, and try it again; its twin goes on asking.
class SceneHostPauseTest : public testing::Test {
 protected:
  // In which of twenty frames a cache is tried; checks that they are the classical ones.
  static std::vector<int> Tries(std::shared_ptr<const Scene> scene, const CacheOptions& options) {
    WorkerPool pool(2);
    SceneHost host(scene, options);
    FrameRequest request;
    request.camera = scene->cameras[0];
    request.width = request.height = 96;
    request.options.max_relative_error = 0;
    std::vector<int> frames;
    for (int i = 0; i < 20; ++i) {
      const auto frame = host.RenderFrame(request, pool);
      EXPECT_TRUE(frame.ok()) << frame.status();
      request.options.mode = Mode::kClassical;
      EXPECT_EQ(frame->radiance, host.RenderFrame(request, pool)->radiance);
      request.options.mode = Mode::kCached;
      if (frame->stats.cells_tried > 0 || frame->stats.cells_unkept > 0) frames.push_back(i);
    }
    return frames;
  }
};

TEST_F(SceneHostPauseTest, ACacheThatIsTooSmallIsTriedNowAndThen) {
  const auto scene = test::BallsOnFloor(300, 70);
  EXPECT_THAT(Tries(scene, {.memory_bytes = CachePause::kLeastBytes}), testing::ElementsAre(0, 16));
  EXPECT_THAT(Tries(scene, {.memory_bytes = CachePause::kLeastBytes, .always_ask = true}),
              testing::SizeIs(20));
  EXPECT_THAT(Tries(scene, {.memory_bytes = CachePause::kLeastBytes - 1}), testing::IsEmpty());
}

// Rays that end on what no lamp lights need no search of the scene: no cell has helped them.
TEST_F(SceneHostPauseTest, RaysThatNeedNoSearchAnywayAreNoReasonToKeepACache) {
  auto scene = std::make_shared<Scene>(*test::BallsOnFloor(1300, 70));
  Material unlit = scene->materials[0];
  unlit.diffuse = {};
  scene->materials.push_back(unlit);
  scene->objects[0].material = static_cast<int>(scene->materials.size()) - 1;
  EXPECT_THAT(Tries(scene, {.memory_bytes = CachePause::kLeastBytes}), testing::ElementsAre(0, 16));
}

// Cells are divided for what a frame has in them, not for where its first rays happen to fall: who
// comes by again finds them as they are.
TEST(SceneHostSharingTest, TheSameFramesOnceMoreBuildFewCellsOnSurfaces) {
  const auto scene = test::BallsOnFloor(8, 70);
  SceneHost host(scene);
  WorkerPool pool(2);
  uint64_t cells[2];
  for (uint64_t& count : cells) {
    for (int view = 0; view < 10; ++view) {
      FrameRequest request;
      request.camera = scene->cameras[0];
      request.camera.eye.x += 0.2 * view;
      request.width = request.height = 128;
      ASSERT_TRUE(host.RenderFrame(request, pool).ok());
    }
    count = host.surfaces().CellCount();
  }
  EXPECT_GT(cells[0], 50u);
  EXPECT_LT(static_cast<double>(cells[1]), 1.1 * static_cast<double>(cells[0]));
}

// Cells of linetrees do not become finer for ever because rays come by again and again.
TEST(SceneHostSharingTest, ManyWhoFlyTheSamePathDoNotBuildManyTimesTheCellsOfLinetrees) {
  auto scene = std::make_shared<Scene>(*test::BallsOnFloor(8, 70));
  for (Material& material : scene->materials) material.reflect = {0.5, 0.5, 0.5};
  SceneHost host(scene);
  WorkerPool pool(2);
  uint64_t cells[2];
  for (uint64_t& count : cells) {
    for (int view = 0; view < 12; ++view) {
      FrameRequest request;
      request.camera = scene->cameras[0];
      request.camera.eye.x += 0.2 * (view % 3);
      request.width = request.height = 256;
      ASSERT_TRUE(host.RenderFrame(request, pool).ok());
    }
    count = host.paths().CellCount();
  }
  EXPECT_GT(cells[0], 50u);
  EXPECT_LT(static_cast<double>(cells[1]), 1.1 * static_cast<double>(cells[0]));
}

}  // namespace
}  // namespace linetree
