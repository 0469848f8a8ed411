#include "core/scene/scene_change.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/scene_builder.h"

namespace linetree {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Matte, red, glass.
Scene FourBalls() {
  Scene scene;
  test::AddMaterial(scene, test::Matte({0.5, 0.5, 0.5}));
  test::AddMaterial(scene, test::Matte({0.9, 0.1, 0.1}));
  test::AddMaterial(scene, test::Glass({0.8, 0.9, 0.7}, 1.5, {0.1, 0.1, 0.1}));
  for (int i = 0; i < 4; ++i) test::AddObject(scene, test::Sphere({3.0 * i, 0, 0}, 1), 0);
  scene.lights.push_back(test::PointLight({0, 0, 9}));
  return scene;
}

TEST(SceneChangeTest, TheSameSceneHasNone) {
  const Scene scene = FourBalls();
  const SceneChange change = ChangeBetween(scene, scene);
  EXPECT_THAT(change.now, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(change.places, IsEmpty());
  EXPECT_TRUE(change.keeps_indices);
  EXPECT_FALSE(change.lights || change.radiance);
}

TEST(SceneChangeTest, AMovedObjectLeavesOnePlaceAndTakesAnother) {
  const Scene former = FourBalls();
  Scene now = former;
  now.objects[1] = test::ObjectOf(test::Sphere({3, 5, 0}, 1), 0);
  const SceneChange change = ChangeBetween(former, now);
  EXPECT_THAT(change.now, ElementsAre(0, SceneChange::kGone, 2, 3));
  EXPECT_THAT(change.places, ElementsAre(former.objects[1].bounds, now.objects[1].bounds));
  EXPECT_TRUE(change.keeps_indices);
}

TEST(SceneChangeTest, ObjectsAfterARemovedOneMoveUp) {
  const Scene former = FourBalls();
  Scene now = former;
  now.objects.erase(now.objects.begin() + 1);
  const SceneChange change = ChangeBetween(former, now);
  EXPECT_THAT(change.now, ElementsAre(0, SceneChange::kGone, 1, 2));
  EXPECT_THAT(change.places, ElementsAre(former.objects[1].bounds));
  EXPECT_FALSE(change.keeps_indices);
}

TEST(SceneChangeTest, TheLastObjectsIndexIsNotKeptForNobody) {
  const Scene former = FourBalls();
  Scene now = former;
  now.objects.pop_back();
  EXPECT_FALSE(ChangeBetween(former, now).keeps_indices);
}

TEST(SceneChangeTest, AddedObjectsMoveNobody) {
  const Scene former = FourBalls();
  Scene now = former;
  test::AddObject(now, test::Sphere({0, 9, 0}, 1), 0);
  const SceneChange change = ChangeBetween(former, now);
  EXPECT_THAT(change.now, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(change.places, ElementsAre(now.objects[4].bounds));
  EXPECT_TRUE(change.keeps_indices);
}

TEST(SceneChangeTest, OtherPaintIsNoPlaceForShadowsButGlassIs) {
  const Scene former = FourBalls();
  Scene now = former;
  now.objects[2].material = 1;
  SceneChange change = ChangeBetween(former, now);
  EXPECT_THAT(change.altered, ElementsAre(false, false, true, false));
  EXPECT_THAT(change.places, IsEmpty());
  now.objects[2].material = 2;
  change = ChangeBetween(former, now);
  EXPECT_THAT(change.altered, ElementsAre(false, false, true, false));
  EXPECT_THAT(change.places, ElementsAre(former.objects[2].bounds));
}

TEST(SceneChangeTest, AMaterialByAnotherNameIsTheSame) {
  const Scene former = FourBalls();
  Scene now = former;
  now.materials[0].name = "other";
  EXPECT_THAT(ChangeBetween(former, now).altered, ElementsAre(false, false, false, false));
}

TEST(SceneChangeTest, OrderIsKeptByAsManyAsPossible) {
  const Scene former = FourBalls();
  Scene now = former;
  std::swap(now.objects[0], now.objects[3]);  // 3 1 2 0
  const SceneChange change = ChangeBetween(former, now);
  EXPECT_THAT(change.now, ElementsAre(SceneChange::kGone, 1, 2, SceneChange::kGone));
  EXPECT_EQ(change.places.size(), 4u);
}

TEST(SceneChangeTest, EqualObjectsAreToldByTheirOrder) {
  Scene former = FourBalls();
  former.objects[2] = former.objects[1];
  Scene now = former;
  now.objects.erase(now.objects.begin() + 1);
  const SceneChange change = ChangeBetween(former, now);
  EXPECT_THAT(change.now, ElementsAre(0, 1, SceneChange::kGone, 2));
}

TEST(SceneChangeTest, LightsAndBackgroundCount) {
  const Scene former = FourBalls();
  Scene now = former;
  now.background = {1, 1, 1};
  EXPECT_FALSE(ChangeBetween(former, now).lights);
  EXPECT_TRUE(ChangeBetween(former, now).radiance);
  now.lights[0].position.z = 8;
  EXPECT_TRUE(ChangeBetween(former, now).lights);
}

}  // namespace
}  // namespace linetree
