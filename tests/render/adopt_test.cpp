// What a changed scene takes over from the one before: every answer is that of a host that has
// known nothing else, and what the change does not touch is kept.
#include <gtest/gtest.h>

#include "core/render/scene_host.h"
#include "tests/support/random_scene.h"
#include "tests/support/render_frame.h"
#include "tests/support/sanitizer_share.h"

namespace linetree {
namespace {

constexpr int kSize = 128;

std::shared_ptr<Scene> CrowdedScene(test::Random& random, int count) {
  auto scene = std::make_shared<Scene>(test::RandomScene(random, count, 3));
  Camera camera;
  camera.eye = random.Direction() * 8;
  camera.up = random.Direction();
  scene->cameras = {camera};
  return scene;
}

FrameRequest Request(const Scene& scene, Mode mode, Lanes lanes, double epsilon) {
  FrameRequest request;
  request.camera = scene.cameras[0];
  request.width = request.height = kSize;
  request.options.mode = mode;
  request.options.judge = JudgeKind::kCertified;
  request.options.lanes = lanes;
  request.options.max_relative_error = epsilon;
  return request;
}

// What an editor does to a scene, at random.
std::shared_ptr<Scene> Edited(const Scene& former, test::Random& random) {
  auto scene = std::make_shared<Scene>(former);
  std::vector<Object>& objects = scene->objects;
  const auto any = [&] {
    return static_cast<size_t>(random.Below(static_cast<int>(objects.size())));
  };
  const auto fresh = [&] {
    const auto kind = test::kShapeKinds[static_cast<size_t>(
        random.Below(static_cast<int>(test::kShapeKinds.size())))];
    return test::ObjectOf(test::RandomShape(kind, random, random.Uniform(0.3, 1), random.InCube(3)),
                          random.Below(6));
  };
  switch (random.Below(7)) {
    case 0:
    case 1:
      objects[any()] = fresh();
      break;
    case 2:
      objects.erase(objects.begin() + static_cast<std::ptrdiff_t>(any()));
      break;
    case 3:
      objects.push_back(fresh());
      break;
    case 4:
      objects[any()].material = random.Below(6);
      break;
    case 5:
      scene->materials[static_cast<size_t>(random.Below(6))] = test::RandomMaterial(random);
      break;
    default:
      scene->lights[static_cast<size_t>(random.Below(3))].irradiance = test::RandomRgb(random, 1);
  }
  return scene;
}

CacheOptions Options() {
  CacheOptions options;
  options.always_ask = true;  // packets ask what is known, whether it pays or not
  return options;
}

void Warm(SceneHost& host, Lanes lanes, double epsilon, WorkerPool& pool) {
  for (int frame = 0; frame < 3; ++frame) {
    test::RenderFrame(host, Request(host.scene(), Mode::kCached, lanes, epsilon), pool);
  }
}

// The former's first frame after the change and those that follow, by the classical tracer's.
void ExpectClassical(SceneHost& host, Lanes lanes, WorkerPool& pool) {
  const Frame classical =
      test::RenderFrame(host, Request(host.scene(), Mode::kClassical, lanes, 0), pool);
  for (int frame = 0; frame < 2; ++frame) {
    const Frame cached =
        test::RenderFrame(host, Request(host.scene(), Mode::kCached, lanes, 0), pool);
    ASSERT_EQ(cached.radiance, classical.radiance);
    ASSERT_EQ(cached.object, classical.object);
  }
  const Frame near =
      test::RenderFrame(host, Request(host.scene(), Mode::kCached, lanes, 0.1), pool);
  const double floor = RadianceFloor(host.scene());
  const double epsilon = 0.1 + near.lane_rounding + 0x1p-22;
  for (size_t i = 0; i < near.radiance.size(); ++i) {
    const double exact = classical.radiance[i];
    ASSERT_LE(std::abs(near.radiance[i] - exact), epsilon * std::max(exact, floor)) << i;
  }
}

TEST(AdoptTest, EditedScenesAnswerAsIfTheyHadAlwaysBeenSo) {
  WorkerPool pool(2);
  Adopted all;
  for (uint64_t seed = 1; seed <= 8 / test::kSanitizerShare; ++seed) {
    test::Random random(seed);
    const Lanes lanes = seed % 2 == 0 ? Lanes::kSimd : Lanes::kScalar;
    auto host =
        std::make_unique<SceneHost>(CrowdedScene(random, seed % 4 < 2 ? 20 : 40), Options());
    Warm(*host, lanes, 0.1, pool);
    for (int edit = 0; edit < 6; ++edit) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << " edit " << edit);
      auto next = std::make_unique<SceneHost>(Edited(host->scene(), random), Options());
      const Adopted adopted = next->Adopt(*host, pool);
      all.kept += adopted.kept;
      all.dropped += adopted.dropped;
      EXPECT_EQ(next->surfaces().ByteSize(), next->surfaces().CountBytes());
      EXPECT_EQ(next->paths().ByteSize(), next->paths().CountBytes());
      EXPECT_EQ(next->surfaces().CellCount() + next->paths().CellCount(), adopted.kept);
      EXPECT_EQ(host->CacheBytes(), 0u);
      host = std::move(next);
      ExpectClassical(*host, lanes, pool);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(all.kept, 1000u / test::kSanitizerShare);
  EXPECT_GT(all.dropped, 1000u / test::kSanitizerShare);
}

// Balls in front of a mirror and on one, a third of them of glass: most of what is seen is seen by
// way of something else, and a ball that moves comes and goes in what others show.
std::shared_ptr<Scene> MirrorsAndBalls(test::Random& random) {
  auto scene = std::make_shared<Scene>();
  scene->ambient = {0.3, 0.3, 0.3};
  scene->background = {0.2, 0.3, 0.4};
  test::AddMaterial(*scene, test::Matte({0.6, 0.5, 0.4}));
  test::AddMaterial(*scene, test::Mirror({0.8, 0.8, 0.8}));
  test::AddMaterial(*scene, test::Glass({0.8, 0.9, 0.7}, 1.5, {0.1, 0.1, 0.1}));
  test::AddObject(*scene, test::Box({-4, -4, -1.2}, {4, 4, -1}), 1);
  test::AddObject(*scene, test::Box({-4, 3, -1}, {4, 3.2, 4}), 1);
  for (int i = 0; i < 9; ++i) {
    const Vec3d center = {-3.0 + 0.75 * i, random.Uniform(-2, 2), random.Uniform(-0.6, 1.5)};
    test::AddObject(*scene, test::Sphere(center, random.Uniform(0.2, 0.35)), i % 3);
  }
  scene->lights.push_back(test::PointLight({2, -3, 6}));
  Camera camera;
  camera.eye = {0.5, -7, 2.5};
  camera.look_at = {0, 1, 0};
  camera.up = {0, 0, 1};
  scene->cameras = {camera};
  return scene;
}

TEST(AdoptTest, WhatIsKnownOfPathsIsKeptOrDroppedRightly) {
  WorkerPool pool(2);
  uint64_t kept = 0;
  for (uint64_t seed = 1; seed <= (test::kSanitizerShare == 1 ? 6 : 2); ++seed) {
    test::Random random(seed);
    auto host = std::make_unique<SceneHost>(MirrorsAndBalls(random));
    for (int edit = 0; edit < 5; ++edit) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << " edit " << edit);
      Warm(*host, Lanes::kScalar, 0, pool);
      Warm(*host, Lanes::kScalar, 0.25, pool);
      auto next = std::make_shared<Scene>(host->scene());
      const size_t ball = 2 + static_cast<size_t>(random.Below(9));
      if (edit % 2 == 0) {
        const Vec3d center = {random.Uniform(-3, 3), random.Uniform(-2, 2),
                              random.Uniform(-0.6, 1)};
        next->objects[ball] = test::ObjectOf(test::Sphere(center, 0.3), random.Below(3));
      } else {
        next->objects[ball].material = random.Below(3);
      }
      auto successor = std::make_unique<SceneHost>(next);
      successor->Adopt(*host, pool);
      kept += successor->paths().CellCount();
      EXPECT_EQ(successor->paths().ByteSize(), successor->paths().CountBytes());
      host = std::move(successor);
      ExpectClassical(*host, Lanes::kScalar, pool);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(kept, 1000u / test::kSanitizerShare);
}

TEST(AdoptTest, TheFormerHostGoesOnAnswering) {
  test::Random random(30);
  WorkerPool pool(2);
  SceneHost former(CrowdedScene(random, 20));
  Warm(former, Lanes::kScalar, 0, pool);
  SceneHost next(Edited(former.scene(), random));
  next.Adopt(former, pool);
  ExpectClassical(former, Lanes::kScalar, pool);
  EXPECT_EQ(former.CacheBytes(), 0u);
}

// A row of rooms without doors: what happens in the last one is nothing to the others.
std::shared_ptr<Scene> Rooms(double ball_at) {
  auto scene = std::make_shared<Scene>();
  scene->ambient = {0.2, 0.2, 0.2};
  test::AddMaterial(*scene, test::Matte({0.5, 0.5, 0.5}));
  for (int room = 0; room < 4; ++room) {
    const double x = 3.0 * room;
    test::AddObject(*scene, test::Box({x - 1.4, -1, -1.1}, {x + 1.4, 1, -1}), 0);
    test::AddObject(*scene, test::Sphere({x, 0, room == 3 ? ball_at : -0.4}, 0.3), 0);
    test::AddObject(*scene, test::Box({x + 1.45, -1, -1}, {x + 1.5, 1, 5}), 0);
  }
  scene->lights.push_back(test::PointLight({0, 0, 2}));
  Camera camera;
  camera.eye = {4, -14, 9};
  camera.look_at = {4, 0, 0};
  camera.up = {0, 0, 1};
  scene->cameras = {camera};
  return scene;
}

TEST(AdoptTest, OnlyWhatTheChangeTouchesIsDropped) {
  WorkerPool pool(2);
  SceneHost former(Rooms(-0.4));
  Warm(former, Lanes::kScalar, 0, pool);
  const uint64_t cells = former.surfaces().CellCount();
  ASSERT_GT(cells, 30u);
  SceneHost next(Rooms(-0.2));
  const Adopted adopted = next.Adopt(former, pool);
  EXPECT_EQ(adopted.kept + adopted.dropped, cells);
  EXPECT_GT(adopted.kept, cells / 2);
  EXPECT_GT(adopted.dropped, 0u);
  ExpectClassical(next, Lanes::kScalar, pool);
}

TEST(AdoptTest, OtherPaintDropsOnlyTheObjectsOwnTree) {
  WorkerPool pool(2);
  SceneHost former(Rooms(-0.4));
  Warm(former, Lanes::kScalar, 0, pool);
  const uint64_t own = former.surfaces().TreeSizes()[10].cells;
  ASSERT_GT(own, 0u);
  auto painted = Rooms(-0.4);
  painted->objects[10].material = test::AddMaterial(*painted, test::Matte({0.9, 0.1, 0.1}));
  SceneHost next(painted);
  EXPECT_EQ(next.Adopt(former, pool).dropped, own);
  ExpectClassical(next, Lanes::kScalar, pool);
}

}  // namespace
}  // namespace linetree
