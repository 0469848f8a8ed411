#include "core/trace/media.h"

#include <gtest/gtest.h>

#include "tests/support/scene_builder.h"

namespace linetree {
namespace {

// A ball (0) in a box (1) in a bigger box (2), each of its own index; one opaque box around all.
Scene Nested() {
  Scene scene;
  const Rgb clear{0.9, 0.9, 0.9};
  test::AddObject(scene, test::Sphere({}, 1), test::AddMaterial(scene, test::Glass(clear, 1.1)));
  test::AddObject(scene, test::Box({-2, -2, -2}, {2, 2, 2}),
                  test::AddMaterial(scene, test::Glass(clear, 1.2)));
  test::AddObject(scene, test::Box({-3, -3, -3}, {3, 3, 3}),
                  test::AddMaterial(scene, test::Glass(clear, 1.3)));
  test::AddObject(scene, test::Box({-9, -9, -9}, {9, 9, 9}),
                  test::AddMaterial(scene, test::Matte({1, 1, 1})));
  return scene;
}

TEST(Media, InnermostSurroundingSolidCounts) {
  const Scene scene = Nested();
  const Media media(scene);
  EXPECT_EQ(media.IorAround(scene, 0, Vec3d{1, 0, 0}), 1.2);
  EXPECT_EQ(media.IorAround(scene, 1, Vec3d{2, 0, 0}), 1.3);
  EXPECT_EQ(media.IorAround(scene, 2, Vec3d{3, 0, 0}), 1) << "opaque solids are no medium";
}

TEST(Media, SurfacesContainNothing) {
  Scene scene;
  const int glass = test::AddMaterial(scene, test::Glass({1, 1, 1}, 1.5));
  test::AddObject(scene, test::Sphere({}, 1), glass);
  test::AddObject(scene, test::Frustum({0, 0, -2}, {0, 0, 2}, 3, 3, true), glass);
  const Media media(scene);
  EXPECT_EQ(media.IorAround(scene, 0, Vec3d{1, 0, 0}), 1);
}

// Overlapping bounds are not enough: the point decides. Of equal volumes the later object wins.
TEST(Media, PointDecidesAndTiesGoToTheLaterObject) {
  Scene scene;
  test::AddObject(scene, test::Sphere({}, 1),
                  test::AddMaterial(scene, test::Glass({1, 1, 1}, 1.5)));
  for (const double ior : {1.6, 1.7}) {
    test::AddObject(scene, test::Box({0, -2, -2}, {4, 2, 2}),
                    test::AddMaterial(scene, test::Glass({1, 1, 1}, ior)));
  }
  const Media media(scene);
  EXPECT_EQ(media.IorAround(scene, 0, Vec3d{1, 0, 0}), 1.7);
  EXPECT_EQ(media.IorAround(scene, 0, Vec3d{-1, 0, 0}), 1);
}

}  // namespace
}  // namespace linetree
