// Batches of rays by packets: whatever the order, the hits are the scalar tracer's bit by bit, and
// answers are within what is promised of its radiance; at epsilon 0 cached ones are the classical
// ones byte by byte.
#include "core/render/ray_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/render/scene_host.h"
#include "tests/support/demo_scenes.h"
#include "tests/support/random_scene.h"

namespace linetree {
namespace {

constexpr RayOrder kOrders[] = {RayOrder::kAsGiven, RayOrder::kBinned, RayOrder::kAuto};

RenderOptions Options(Mode mode, double epsilon, RayOrder order) {
  RenderOptions options;
  options.mode = mode;
  options.lanes = Lanes::kSimd;
  options.max_relative_error = epsilon;
  options.ray_order = order;
  return options;
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
  for (int i = 0; i < 6; ++i) {
    scene->lights.push_back(test::PointLight(Vec3d{0, 0, 7} + random.InCube(3)));
    scene->lights.back().irradiance = {0.1, 0.1, 0.1};
  }
  return scene;
}

std::shared_ptr<const Scene> ManyLights(uint64_t seed) {
  auto scene = std::make_shared<Scene>(*test::BallsOnFloor(12, seed));
  test::Random random(seed);
  for (int i = 0; i < 20; ++i) {
    scene->lights.push_back(test::PointLight(Vec3d{0, 0, 9} + random.InCube(3)));
    scene->lights.back().irradiance = {0.1, 0.1, 0.1};
  }
  return scene;
}

// From anywhere around in any direction; neither whole blocks nor whole packets.
std::vector<Ray> RandomRays(uint64_t seed, size_t count = 3007) {
  test::Random random(seed + 1000);
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) ray = {random.InCube(3), random.Direction() * random.Uniform(0.1, 9)};
  return rays;
}

std::vector<Ray> EyeRaysOf(const Camera& camera, int width, int height) {
  const EyeRays eye_rays(camera, width, height);
  std::vector<Ray> rays;
  for (int i = 0; i < width * height; ++i) {
    rays.push_back(eye_rays.ThroughPixel(i % width, i / width));
  }
  return rays;
}

RayBatch Answers(SceneHost& host, const std::vector<Ray>& rays, const RenderOptions& options,
                 WorkerPool& pool) {
  auto batch = host.TraceRays(rays, options, pool);
  EXPECT_TRUE(batch.ok()) << batch.status();
  return *std::move(batch);
}

// Radiance, hit by hit.
void ExpectSame(const RayBatch& a, const RayBatch& b, const std::string& what) {
  ASSERT_EQ(a.answers.size(), b.answers.size());
  for (size_t i = 0; i < a.answers.size(); ++i) {
    ASSERT_EQ(a.answers[i].radiance, b.answers[i].radiance) << what << ", ray " << i;
    ASSERT_EQ(a.answers[i].object, b.answers[i].object) << what << ", ray " << i;
    ASSERT_EQ(a.answers[i].depth, b.answers[i].depth) << what << ", ray " << i;
  }
}

// Largest error relative to max(classical, floor); hits must be equal.
double LargestError(const RayBatch& batch, const RayBatch& scalar, double floor) {
  double largest = 0;
  for (size_t i = 0; i < batch.answers.size(); ++i) {
    const RayAnswer &answer = batch.answers[i], &truth = scalar.answers[i];
    EXPECT_EQ(answer.object, truth.object) << "ray " << i;
    EXPECT_EQ(answer.depth, truth.depth) << "ray " << i;
    for (int c = 0; c < 3; ++c) {
      const double off = std::abs(answer.radiance[c] - truth.radiance[c]);
      largest = std::max(largest, off / std::max(truth.radiance[c], floor));
    }
  }
  return largest;
}

RayBatch Scalar(SceneHost& host, const std::vector<Ray>& rays, WorkerPool& pool) {
  RenderOptions options = Options(Mode::kClassical, 0, RayOrder::kAuto);
  options.lanes = Lanes::kScalar;
  RayBatch batch = Answers(host, rays, options, pool);
  EXPECT_EQ(batch.lane_rounding, 0);
  return batch;
}

TEST(RayBlocksTest, ClassicalOnesAreTheScalarTracersInEveryOrder) {
  WorkerPool pool(2);
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const auto scene = RandomScene(seed);
    SceneHost host(scene);
    const std::vector<Ray> rays = RandomRays(seed);
    const RayBatch scalar = Scalar(host, rays, pool);
    RayBatch first;
    for (const RayOrder order : kOrders) {
      const RayBatch batch = Answers(host, rays, Options(Mode::kClassical, 0, order), pool);
      EXPECT_GT(batch.lane_rounding, 0);
      EXPECT_LE(LargestError(batch, scalar, RadianceFloor(*scene)), batch.lane_rounding);
      EXPECT_EQ(batch.stats.base, scalar.stats.base) << "scene " << seed;
      EXPECT_EQ(batch.stats.traced, scalar.stats.traced);
      EXPECT_EQ(batch.stats.background, scalar.stats.background);
      if (order == kOrders[0]) first = batch;
      ExpectSame(batch, first, "scene " + std::to_string(seed));
    }
  }
}

// Where few rays branch, several of one path meet again in a packet, among those of other paths.
TEST(RayBlocksTest, LightOfDeepPathsIsSummedAsOfEachRayAlone) {
  WorkerPool pool(1);
  uint64_t deep = 0;
  for (uint64_t seed = 0; seed < 40; ++seed) {
    auto scene = std::make_shared<Scene>(*RandomScene(seed));
    test::Random random(seed);
    for (Material& material : scene->materials) {
      material.reflect = test::RandomRgb(random, 0.9);
      material.transmit = test::RandomRgb(random, 0.9);
    }
    SceneHost host(scene);
    RenderOptions options = Options(Mode::kClassical, 0, RayOrder::kAsGiven);
    options.limits.max_depth = 7;
    options.limits.min_weight = 1e-3;
    const std::vector<Ray> rays = RandomRays(seed, 240);
    for (size_t first = 0; first < rays.size(); first += 6) {
      const std::vector<Ray> few(rays.begin() + static_cast<std::ptrdiff_t>(first),
                                 rays.begin() + static_cast<std::ptrdiff_t>(first) + 6);
      const RayBatch together = Answers(host, few, options, pool);
      RayBatch alone;
      for (const Ray& ray : few) {
        alone.answers.push_back(Answers(host, {ray}, options, pool).answers[0]);
      }
      ExpectSame(together, alone, "scene " + std::to_string(seed));
      deep += together.stats.base.reflected + together.stats.base.refracted;
    }
  }
  EXPECT_GT(deep, 10'000u);
}

TEST(RayBlocksTest, AtEpsilonZeroTheyAreClassicalByteByByte) {
  WorkerPool pool(2);
  uint64_t listed = 0, replayed = 0;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const auto scene = RandomScene(seed);
    for (const RayOrder order : {RayOrder::kAsGiven, RayOrder::kBinned}) {
      SceneHost host(scene, AlwaysAsk());
      for (uint64_t turn = 0; turn < 3; ++turn) {
        const std::vector<Ray> rays = RandomRays(10 * seed + turn);
        const RayBatch classical = Answers(host, rays, Options(Mode::kClassical, 0, order), pool);
        const RayBatch cached = Answers(host, rays, Options(Mode::kCached, 0, order), pool);
        ExpectSame(cached, classical, "scene " + std::to_string(seed));
        EXPECT_EQ(cached.stats.interpolated, 0u);
        EXPECT_EQ(host.surfaces().ByteSize(), host.surfaces().CountBytes());
        listed += cached.stats.base.listed;
        replayed += cached.stats.replayed;
      }
    }
  }
  EXPECT_GT(listed, 20'000u);
  EXPECT_GT(replayed, 5'000u);
}

TEST(RayBlocksTest, TheyAreWithinEpsilonOfTheScalarTracer) {
  WorkerPool pool(2);
  uint64_t interpolated = 0;
  double largest = 0;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const auto scene = RandomScene(seed);
    SceneHost plain(scene);
    std::array<std::vector<Ray>, 2> rays;
    std::array<RayBatch, 2> scalar;
    for (size_t turn = 0; turn < rays.size(); ++turn) {
      rays[turn] = RandomRays(10 * seed + turn, 6007);
      scalar[turn] = Scalar(plain, rays[turn], pool);
    }
    for (const RayOrder order : {RayOrder::kAsGiven, RayOrder::kBinned}) {
      SceneHost host(scene, AlwaysAsk());
      for (const double epsilon : {0.25, 0.02, 1e-7}) {
        for (size_t turn = 0; turn < rays.size(); ++turn) {
          const RayBatch cached =
              Answers(host, rays[turn], Options(Mode::kCached, epsilon, order), pool);
          const double error = LargestError(cached, scalar[turn], RadianceFloor(*scene));
          EXPECT_LE(error, epsilon + cached.lane_rounding) << "scene " << seed;
          largest = std::max(largest, error);
          interpolated += cached.stats.interpolated;
          if (epsilon < 1e-6) {
            EXPECT_EQ(cached.stats.interpolated, 0u) << "no room for sums";
          }
        }
      }
    }
  }
  EXPECT_GT(interpolated, 1'000u);
  EXPECT_GT(largest, 1e-4) << "sums were used";
}

// Of a cache that has settled; at epsilon 0 and classically of any (above).
TEST(RayBlocksTest, PermutedBatchesGivePermutedAnswers) {
  WorkerPool pool(2);
  SceneHost host(ManyLights(90), AlwaysAsk());
  const std::vector<Ray> rays = RandomRays(91, 5000);
  std::vector<size_t> places(rays.size());
  std::iota(places.begin(), places.end(), size_t{0});
  test::Random random(92);
  for (size_t i = places.size() - 1; i > 0; --i) {
    std::swap(places[i], places[static_cast<size_t>(random.Below(static_cast<int>(i) + 1))]);
  }
  std::vector<Ray> permuted;
  for (const size_t place : places) permuted.push_back(rays[place]);
  for (const RayOrder order : kOrders) {
    const RenderOptions options = Options(Mode::kCached, 0.1, order);
    RayBatch batch = Answers(host, rays, options, pool);
    for (int turn = 0; turn < 20 && batch.stats.cells_tried > 0; ++turn) {
      batch = Answers(host, rays, options, pool);
    }
    ASSERT_EQ(batch.stats.cells_tried, 0u);
    EXPECT_GT(batch.stats.interpolated, 100u);
    const RayBatch other = Answers(host, permuted, options, pool);
    for (size_t i = 0; i < places.size(); ++i) {
      ASSERT_EQ(other.answers[i].radiance, batch.answers[places[i]].radiance) << i;
      ASSERT_EQ(other.answers[i].source, batch.answers[places[i]].source) << i;
      ASSERT_EQ(other.answers[i].verdict, batch.answers[places[i]].verdict) << i;
      ASSERT_EQ(other.answers[i].depth, batch.answers[places[i]].depth) << i;
    }
  }
}

TEST(RayBlocksTest, ThreadsChangeNothing) {
  const auto scene = ManyLights(93);
  for (const RayOrder order : {RayOrder::kAsGiven, RayOrder::kBinned}) {
    RayBatch batches[2];
    for (const int threads : {1, 3}) {
      WorkerPool pool(threads);
      SceneHost host(scene, AlwaysAsk());
      for (uint64_t turn = 0; turn < 3; ++turn) {
        batches[threads == 1 ? 0 : 1] =
            Answers(host, RandomRays(94 + turn, 20'000), Options(Mode::kCached, 0.1, order), pool);
      }
    }
    ExpectSame(batches[0], batches[1], "threads");
    EXPECT_EQ(batches[0].stats.base, batches[1].stats.base);
    EXPECT_EQ(batches[0].stats.interpolated, batches[1].stats.interpolated);
    EXPECT_EQ(batches[0].stats.cells_tried, batches[1].stats.cells_tried);
  }
}

TEST(RayBlocksTest, EyeRaysGiveTheFrame) {
  const auto scene = test::BallsOnFloor(12, 95);
  WorkerPool pool(2);
  SceneHost host(scene);
  FrameRequest request;
  request.camera = scene->cameras[0];
  request.width = request.height = 64;
  request.options = Options(Mode::kClassical, 0, RayOrder::kAuto);
  const auto frame = host.RenderFrame(request, pool);
  ASSERT_TRUE(frame.ok());
  const RayBatch batch = Answers(host, EyeRaysOf(request.camera, 64, 64), request.options, pool);
  EXPECT_EQ(batch.lane_rounding, frame->lane_rounding);
  for (size_t i = 0; i < batch.answers.size(); ++i) {
    EXPECT_EQ(batch.answers[i].object, frame->object[i]);
    for (size_t c = 0; c < 3; ++c) {
      // Directions are made unit length again, which may move their last bit.
      EXPECT_NEAR(batch.answers[i].radiance[static_cast<int>(c)],
                  static_cast<double>(frame->radiance[3 * i + c]), 1e-5);
    }
  }
}

TEST(RayBlocksTest, SourcesAddUp) {
  const auto scene = test::BallsOnFloor(12, 96);
  WorkerPool pool(2);
  SceneHost host(scene, AlwaysAsk());
  for (uint64_t turn = 0; turn < 3; ++turn) {
    const RayBatch batch =
        Answers(host, RandomRays(97 + turn), Options(Mode::kCached, 0.1, RayOrder::kAuto), pool);
    const FrameStats& stats = batch.stats;
    EXPECT_EQ(stats.pixels, batch.answers.size());
    EXPECT_EQ(stats.base.eye, stats.pixels);
    EXPECT_EQ(stats.interpolated + stats.traced + stats.background, stats.pixels);
    EXPECT_LE(stats.replayed + stats.residual, stats.traced);
    EXPECT_EQ(stats.verdicts[static_cast<size_t>(Verdict::kCertified)], stats.interpolated);
    EXPECT_EQ(stats.cache_bytes, host.CacheBytes());
    for (const RayAnswer& answer : batch.answers) {
      EXPECT_EQ(answer.source == Source::kBackground, answer.object == kNoObject);
      EXPECT_EQ(std::isinf(answer.depth), answer.object == kNoObject);
    }
  }
}

TEST(RayBlocksTest, SmallBatchesTeachNothing) {
  const auto scene = test::BallsOnFloor(12, 98);
  WorkerPool pool(1);
  SceneHost host(scene, AlwaysAsk());
  const RenderOptions options = Options(Mode::kCached, 0.1, RayOrder::kAuto);
  for (const size_t count : {size_t{0}, size_t{1}, kLeastTeachingRays - 1}) {
    EXPECT_EQ(Answers(host, RandomRays(99, count), options, pool).answers.size(), count);
  }
  EXPECT_EQ(host.surfaces().CellCount(), 0u);
  Answers(host, RandomRays(99, 4 * kLeastTeachingRays), options, pool);
  Answers(host, RandomRays(99, 4 * kLeastTeachingRays), options, pool);
  EXPECT_GT(host.surfaces().CellCount(), 0u);
}

TEST(RayBlocksTest, WhatPacketsCannotDoGoesRayByRay) {
  WorkerPool pool(1);
  const std::vector<Ray> rays = RandomRays(100, 500);
  SceneHost host(test::BallsOnFloor(5, 101));
  RenderOptions paper = Options(Mode::kCached, 0.1, RayOrder::kAuto);
  paper.judge = JudgeKind::kPaper;
  EXPECT_EQ(Answers(host, rays, paper, pool).lane_rounding, 0);

  auto scene = std::make_shared<Scene>(*test::BallsOnFloor(5, 101));
  scene->lights[0].position = {0, 0, 1e12};  // beyond float
  SceneHost wide(scene);
  const RayBatch batch = Answers(wide, rays, Options(Mode::kClassical, 0, RayOrder::kBinned), pool);
  EXPECT_EQ(batch.lane_rounding, 0);
  ExpectSame(batch, Scalar(wide, rays, pool), "beyond float");
}

TEST(RayBlocksTest, OddRaysAreAnsweredAsTheScalarTracerDoes) {
  const auto scene = test::BallsOnFloor(12, 102);
  WorkerPool pool(1);
  SceneHost host(scene);
  std::vector<Ray> rays = RandomRays(103, 100);
  for (const double far : {1e5, 1e9, 1e30, 1e150}) {
    rays.push_back({{0, 0, far}, {0, 0, -1}});
    rays.push_back({{-far, far, 1}, {far, -far, 0}});
  }
  rays.push_back({{0, 0, 1}, {0, 0, -1e300}});
  rays.push_back({{0, 0, 1}, {0, 0, -5e-324}});
  rays.push_back({{0, 0, 0}, {1, 0, 0}});
  const RayBatch scalar = Scalar(host, rays, pool);
  for (const RayOrder order : kOrders) {
    const RayBatch batch = Answers(host, rays, Options(Mode::kClassical, 0, order), pool);
    EXPECT_LE(LargestError(batch, scalar, RadianceFloor(*scene)), batch.lane_rounding);
  }
}

TEST(RayBlocksTest, BadRaysAreRefusedByIndex) {
  WorkerPool pool(2);
  SceneHost host(test::BallsOnFloor(5, 104));
  std::vector<Ray> rays = RandomRays(105, 9000);
  rays[8000].direction = {};
  rays[8500].origin.x = std::nan("");
  const auto batch = host.TraceRays(rays, Options(Mode::kClassical, 0, RayOrder::kAuto), pool);
  ASSERT_EQ(batch.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_NE(batch.status().message().find("rays[8000].direction"), std::string::npos);
}

TEST(RayBlocksTest, WhoCancelsGetsNothing) {
  WorkerPool pool(2);
  SceneHost host(test::BallsOnFloor(5, 106), AlwaysAsk());
  CancelToken cancel;
  cancel.Cancel();
  for (const RayOrder order : kOrders) {
    for (const Mode mode : {Mode::kClassical, Mode::kCached}) {
      const auto batch = host.TraceRays(RandomRays(107), Options(mode, 0.1, order), pool, &cancel);
      EXPECT_EQ(batch.status().code(), absl::StatusCode::kCancelled);
    }
  }
  EXPECT_EQ(host.totals().ray_batches, 0u);
  EXPECT_EQ(host.surfaces().CellCount(), 0u);
}

}  // namespace
}  // namespace linetree
