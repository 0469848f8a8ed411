#include "core/cache/change_reach.h"

#include <gtest/gtest.h>

#include "tests/support/scene_builder.h"

namespace linetree {
namespace {

// A mirror in the plane y = 0 and a wall at y = 10, and a lamp high above x = 20: what lies between
// the three lies in different places.
Scene MirrorAndWall() {
  Scene scene;
  test::AddMaterial(scene, test::Mirror({0.9, 0.9, 0.9}));
  test::AddMaterial(scene, test::Matte({0.5, 0.5, 0.5}));
  test::AddObject(scene, test::Box({-1, -1, -1}, {1, 0, 1}), 0);
  test::AddObject(scene, test::Box({-1, 10, -1}, {1, 11, 1}), 1);
  scene.lights.push_back(test::PointLight({20, 5, 40}));
  return scene;
}

// What a cell of the mirror says: its rays are reflected to the wall, and meet nothing else.
struct MirrorCell {
  explicit MirrorCell(const Scene& scene, bool interpolates = false)
      : tree(scene.objects[0]), node(const_cast<PathNode&>(tree.cells().Leaf(0, {}))) {
    auto paths = std::make_unique<CellPaths>();
    paths->steps = {{.object = 0, .reflected = 1}, {.object = 1, .listed = true}};
    paths->objects = {1};
    paths->steps[1].candidates = paths->objects;
    if (interpolates) paths->interpolant = std::make_unique<Interpolant>();
    std::unique_ptr<const CellPaths> known = std::move(paths);
    node.payload.PutFirst(known);
  }
  PathTree tree;
  PathNode& node;
};

// Whether a ball there touches what the cell knows.
bool BallTouches(const Vec3d& center, bool interpolates, double radius = 0.2) {
  const Scene former = MirrorAndWall();
  Scene now = former;
  test::AddObject(now, test::Sphere(center, radius), 1);
  const SceneChange change = ChangeBetween(former, now);
  const MirrorCell cell(former, interpolates);
  return ChangeReach(now, change).Touches(cell.tree, cell.node);
}

TEST(ChangeReachTest, WhatComesBetweenTheEndsOfALegTouchesIt) {
  EXPECT_TRUE(BallTouches({0, 5, 0}, false));
  EXPECT_TRUE(BallTouches({1.1, 5, 0}, false)) << "by its rim";
  EXPECT_FALSE(BallTouches({1.3, 5, 0}, false));
  EXPECT_FALSE(BallTouches({0, 12, 0}, false)) << "behind the wall";
}

// A solid around the end of a leg turns the rays that leave it, whatever the leg itself can meet.
TEST(ChangeReachTest, LegsWithoutAListAreTouchedToo) {
  const Scene former = MirrorAndWall();
  Scene now = former;
  test::AddObject(now, test::Sphere({0, 0, 0}, 0.2), 1);
  const SceneChange change = ChangeBetween(former, now);
  const MirrorCell cell(former);
  const_cast<CellPaths&>(*cell.node.payload).steps[1].listed = false;
  EXPECT_TRUE(ChangeReach(now, change).Touches(cell.tree, cell.node));
}

TEST(ChangeReachTest, WhatComesBeforeALampTouchesInterpolantsOnly) {
  for (const Vec3d from : {Vec3d{0, 0, 0}, Vec3d{0, 10, 0}}) {
    const Vec3d lamp = {20, 5, 40}, between = from + (lamp - from) * 0.5;
    EXPECT_TRUE(BallTouches(between, true));
    EXPECT_FALSE(BallTouches(between, false));
  }
  EXPECT_FALSE(BallTouches({-20, 5, 40}, true));
}

TEST(ChangeReachTest, OtherLightAndOtherMaterialsCount) {
  const Scene former = MirrorAndWall();
  const auto touches = [&](const Scene& now, bool interpolates) {
    const SceneChange change = ChangeBetween(former, now);
    const MirrorCell cell(former, interpolates);
    return ChangeReach(now, change).Touches(cell.tree, cell.node);
  };
  Scene now = former;
  now.lights[0].irradiance = {2, 2, 2};
  EXPECT_TRUE(touches(now, true));
  EXPECT_FALSE(touches(now, false)) << "rays go where they went";
  now = former;
  now.materials[1].diffuse = {0.1, 0.1, 0.1};
  EXPECT_TRUE(touches(now, false)) << "the wall is named";
}

TEST(ChangeReachTest, RaysThatLeaveTheSceneMayMeetAnythingNew) {
  const Scene former = MirrorAndWall();
  Scene now = former;
  test::AddObject(now, test::Sphere({50, 50, 50}, 1), 1);
  const SceneChange change = ChangeBetween(former, now);
  const MirrorCell cell(former);
  auto& steps = const_cast<CellPaths&>(*cell.node.payload).steps;
  EXPECT_FALSE(ChangeReach(now, change).Touches(cell.tree, cell.node));
  steps[1].object = kNoObject;
  EXPECT_TRUE(ChangeReach(now, change).Touches(cell.tree, cell.node));
  steps[1].listed = false;
  EXPECT_FALSE(ChangeReach(now, change).Touches(cell.tree, cell.node)) << "nothing is said";
}

TEST(ChangeReachTest, ManyPlacesAreTakenForOne) {
  const Scene former = MirrorAndWall();
  Scene now = former;
  for (int i = 0; i < 40; ++i) {
    test::AddObject(now, test::Sphere({0, 30.0 + i, 0}, 0.2), 1);
  }
  test::AddObject(now, test::Sphere({0, 5, 0}, 0.2), 1);
  const SceneChange change = ChangeBetween(former, now);
  const MirrorCell cell(former);
  EXPECT_TRUE(ChangeReach(now, change).Touches(cell.tree, cell.node));
}

TEST(ChangeReachTest, IndicesAreRewrittenAndTheGoneAreNoticed) {
  const std::vector<int32_t> now = {1, SceneChange::kGone, 0};
  CellPaths paths;
  paths.steps = {{.object = 0}, {.object = kNoObject}};
  paths.objects = {0, 2};
  EXPECT_TRUE(Renumber(now, paths));
  EXPECT_EQ(paths.steps[0].object, 1);
  EXPECT_EQ(paths.steps[1].object, kNoObject);
  EXPECT_EQ(paths.objects, (std::vector<int32_t>{1, 0}));
  CellLights lights;
  lights.lights.resize(1);
  lights.lights[0].occluder = 1;
  EXPECT_FALSE(Renumber(now, lights));
}

}  // namespace
}  // namespace linetree
