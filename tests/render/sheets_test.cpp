// Tiles that are evaluated as sheets (core/frame/sheet-inl.h), in rooms that are all but made of
// them: within epsilon of the scalar tracer, whatever the trees hold.
#include <gtest/gtest.h>

#include <cmath>

#include "core/frame/frame_kernels.h"
#include "core/render/scene_host.h"
#include "tests/support/matte_rooms.h"
#include "tests/support/render_frame.h"
#include "tests/support/sanitizer_share.h"

namespace linetree {
namespace {

// In float: the distance along the axis of view, and what the pixel's ray is longer by.
constexpr double kDepthRounding = 0x1p-20;

FrameRequest Request(const Camera& camera, Mode mode, Lanes lanes, double epsilon) {
  FrameRequest request;
  request.camera = camera;
  request.width = 93;  // neither whole blocks nor whole tiles
  request.height = 70;
  request.options.mode = mode;
  request.options.lanes = lanes;
  request.options.max_relative_error = epsilon;
  return request;
}

// Pixels that are answered as sheets, with the trees as they are.
uint64_t CountOnSheets(SceneHost& host, const FrameRequest& request) {
  const EyeRays eye_rays(request.camera, request.width, request.height);
  const double error = request.options.max_relative_error - host.packets().radiance_rounding();
  const SurfaceCache::Reader reader(host.surfaces(), error);
  FramePlan plan(host.packets().tracer().scene().objects.size(), true);
  std::vector<float> radiance(static_cast<size_t>(3 * request.width * request.height));
  const PixelTarget target = {radiance.data()};
  PacketWorkspace workspace;
  PacketCounts counts;
  for (int row = 0; row < request.height; row += kBlockSide) {
    for (int column = 0; column < request.width; column += kBlockSide) {
      const PacketTracer::Region region = {column, row,
                                           std::min(kBlockSide, request.width - column),
                                           std::min(kBlockSide, request.height - row)};
      const BlockTask task = {
          eye_rays, region, request.options.limits, static_cast<size_t>(request.width),
          target,   true};
      RenderFrameBlockWide(host.packets().scene(), task, reader, plan, Asking::kPlanned, nullptr,
                           workspace, counts);
    }
  }
  return counts.on_sheets;
}

struct Totals {
  uint64_t pixels = 0, on_sheets = 0;
  double largest = 0;  // error, as a share of what is allowed
};

void ExpectWithin(const Scene& scene, const Frame& frame, const Frame& truth, double epsilon,
                  Totals& totals) {
  ASSERT_EQ(frame.object, truth.object);
  const double allowed = epsilon + frame.lane_rounding + 0x1p-23;
  for (size_t i = 0; i < frame.radiance.size(); ++i) {
    const double wanted = truth.radiance[i];
    const double error = std::abs(static_cast<double>(frame.radiance[i]) - wanted);
    const double most = allowed * std::max(wanted, RadianceFloor(scene));
    ASSERT_LE(error, most) << "pixel " << i / 3 << " of " << wanted;
    totals.largest = std::max(totals.largest, error / most);
  }
  for (size_t i = 0; i < frame.depth.size(); ++i) {
    if (frame.object[i] == kNoObject) continue;
    ASSERT_NEAR(frame.depth[i], truth.depth[i], kDepthRounding * truth.depth[i]) << "pixel " << i;
  }
}

void CheckRoom(const std::shared_ptr<const Scene>& scene, bool always_ask, Totals& totals) {
  WorkerPool pool(1);
  for (size_t c = 0; c < scene->cameras.size(); ++c) {
    const Camera& camera = scene->cameras[c];
    CacheOptions options;
    options.always_ask = always_ask;
    SceneHost host(scene, options);
    ASSERT_TRUE(host.packets().IsWide());
    const auto render = [&](Mode mode, Lanes lanes, double epsilon) {
      return test::RenderFrame(host, Request(camera, mode, lanes, epsilon), pool);
    };
    const Frame truth = render(Mode::kClassical, Lanes::kScalar, 0);
    const Frame classical = render(Mode::kClassical, Lanes::kSimd, 0);
    for (const double epsilon : {0.25, 0.02, 1e-3, 1e-4, 0.0}) {
      for (int repeat = 0; repeat < (epsilon == 0.25 ? 3 : 1); ++repeat) {
        const Frame frame = render(Mode::kCached, Lanes::kSimd, epsilon);
        SCOPED_TRACE(testing::Message() << "camera " << c << ", epsilon " << epsilon << ", frame "
                                        << repeat << ", always " << always_ask);
        ExpectWithin(*scene, frame, truth, epsilon, totals);
        if (testing::Test::HasFatalFailure()) return;
        if (epsilon > 0) continue;
        ASSERT_EQ(frame.radiance, classical.radiance);
        ASSERT_EQ(frame.depth, classical.depth);
      }
    }
    totals.pixels += truth.object.size();
    totals.on_sheets += CountOnSheets(host, Request(camera, Mode::kCached, Lanes::kSimd, 0.02));
  }
}

TEST(SheetsTest, MatteRoomsAreWithinEpsilonOfTheScalarTracer) {
  Totals totals;
  const uint64_t seeds = 48 / test::kSanitizerShare;
  for (uint64_t seed = 0; seed < seeds; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    CheckRoom(test::MatteRoom(seed), seed % 4 != 3, totals);
    if (HasFatalFailure()) return;
  }
  std::printf("%.0f %% on sheets; largest error %.3f of what is allowed\n",
              100 * static_cast<double>(totals.on_sheets) / static_cast<double>(totals.pixels),
              totals.largest);
  EXPECT_GT(totals.on_sheets, totals.pixels / 8);
  EXPECT_GT(totals.largest, 0.05);
}

std::shared_ptr<Scene> MatteScene() {
  auto scene = std::make_shared<Scene>();
  scene->ambient = {0.1, 0.1, 0.1};
  Material material = test::Matte({0.5, 0.6, 0.7});
  material.ambient = {0.1, 0.1, 0.1};
  scene->materials = {material};
  return scene;
}

// The strip of floor behind a wall that stands on it, which is too narrow to divide cells for, is
// dark: what the floor's cells say holds in front of the wall.
TEST(SheetsTest, WhatLiesBehindAContactIsNotInTheCell) {
  for (const double width : {0x1p-13, 0x1p-14, 0x1p-15}) {
    const auto scene = MatteScene();
    scene->objects = {
        test::ObjectOf(test::Polygon({{-width, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-width, 1, 0}})),
        test::ObjectOf(test::Polygon({{0, -1, 0}, {0, 1, 0}, {0, 1, 1}, {0, -1, 1}}))};
    scene->lights = {test::PointLight({0.5, 0, 0.8})};
    const double narrow_deg = 60 * width;
    const Vec3d strip{-width / 2, 0.1, 0};
    scene->cameras = {{"before", {0.7, -0.5, 0.5}, {0.4, 0, 0}, {0, 0, 1}, 30},
                      {"behind", {-0.3, 0.1, 0.3}, strip, {0, 0, 1}, narrow_deg}};
    Totals totals;
    CheckRoom(scene, true, totals);
    if (HasFatalFailure()) return;
    EXPECT_GT(totals.on_sheets, totals.pixels / 4) << "of the one that looks before the wall";
  }
}

// Strong lights so close to a face's plane, over it and beside it, that rounding decides how high
// they are above it; eyes near, and so far away that hits are off the plane by as much.
TEST(SheetsTest, LightsAllButInTheFacesPlane) {
  Totals totals;
  for (uint64_t seed = 0; seed < 120 / test::kSanitizerShare; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Random random(seed);
    const auto scene = MatteScene();
    const Vec3d n = random.Direction(), at = random.Direction() * random.LogUniform(1, 1e4);
    const Vec3d u = Normalized(Cross(n, random.Direction())), v = Cross(n, u);
    if (seed % 3 == 0) {
      scene->objects = {test::ObjectOf(test::Polyhedron({{n, Dot(n, at)},
                                                         {-n, 0.1 - Dot(n, at)},
                                                         {u, Dot(u, at) + 1},
                                                         {-u, 1 - Dot(u, at)},
                                                         {v, Dot(v, at) + 1},
                                                         {-v, 1 - Dot(v, at)}}))};
    } else {
      scene->objects = {
          test::ObjectOf(test::Polygon({at - u - v, at + u - v, at + u + v, at - u + v}))};
    }
    const bool beside = seed % 2 == 0;
    const double away = beside ? random.Uniform(8, 30) : random.Uniform(-1, 1);
    const double side = random.Below(3) == 0 ? -1 : 1;
    const double height =
        side * (beside ? away * random.LogUniform(1e-14, 1e-8) : random.LogUniform(1e-14, 1e-6));
    const Vec3d along = u * away + v * random.Uniform(-1, 1);
    scene->lights = {test::PointLight(at + along + n * height, {5e8, 5e8, 5e8})};
    if (seed % 4 < 2) {
      scene->lights.push_back(test::DirectionalLight(u + n * height, {5e8, 5e8, 5e8}));
    }
    const double far = random.LogUniform(1e3, 1e6);
    scene->cameras = {{"near", at + n * 2 + u * random.Uniform(-1, 1), at, v, 50},
                      {"far", at + n * far + u * far, at, v, 60 / far}};
    CheckRoom(scene, true, totals);
    if (HasFatalFailure()) return;
  }
  std::printf("largest error %.3f of what is allowed\n", totals.largest);
  // Few are: the first of them come late.
  if (test::kSanitizerShare == 1) {
    EXPECT_GT(totals.on_sheets, 0u);
  }
}

}  // namespace
}  // namespace linetree
