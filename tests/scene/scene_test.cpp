#include "core/scene/scene.h"

#include <gtest/gtest.h>

#include "tests/support/scene_builder.h"

namespace linetree {
namespace {

TEST(Scene, WorldBoundsEncloseAllObjects) {
  Scene scene;
  EXPECT_TRUE(scene.WorldBounds().IsEmpty());
  test::AddObject(scene, test::Sphere({5, 0, 0}, 1));
  test::AddObject(scene, test::Box({-3, -2, -1}, {0, 0, 0}));
  const Box3 bounds = scene.WorldBounds();
  EXPECT_NEAR(bounds.min.x, -3, 1e-12);
  EXPECT_NEAR(bounds.max.x, 6, 1e-12);
  EXPECT_NEAR(bounds.min.y, -2, 1e-12);
  EXPECT_NEAR(bounds.max.z, 1, 1e-12);
}

TEST(Scene, CamerasAreFoundByName) {
  Scene scene;
  EXPECT_EQ(scene.FindCamera(""), nullptr);
  scene.cameras.resize(2);
  scene.cameras[0].name = "front";
  scene.cameras[1].name = "top";
  EXPECT_EQ(scene.FindCamera(""), &scene.cameras[0]);
  EXPECT_EQ(scene.FindCamera("top"), &scene.cameras[1]);
  EXPECT_EQ(scene.FindCamera("left"), nullptr);
}

TEST(Scene, MaterialsAreLookedUpByObject) {
  Scene scene;
  test::AddMaterial(scene, test::Matte({1, 0, 0}));
  test::AddMaterial(scene, test::Matte({0, 1, 0}));
  test::AddObject(scene, test::Sphere({}, 1), 1);
  test::AddObject(scene, test::Sphere({}, 1), 0);
  EXPECT_EQ(scene.MaterialOf(0).diffuse, (Rgb{0, 1, 0}));
  EXPECT_EQ(scene.MaterialOf(1).diffuse, (Rgb{1, 0, 0}));
}

TEST(Scene, FloorIsAShareOfWhite) {
  Scene scene;
  scene.white = 2;
  EXPECT_EQ(RadianceFloor(scene), 2 * kFloorOfWhite);
}

}  // namespace
}  // namespace linetree
