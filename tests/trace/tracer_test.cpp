// Hits and shadows. Radiance is in path_test.cpp.
#include "core/trace/tracer.h"

#include <gtest/gtest.h>

#include "tests/support/scene_builder.h"

namespace linetree {
namespace {

TEST(Intersect, NearestHitWithPointAndNormal) {
  Scene scene;
  test::AddMaterial(scene, test::Matte({1, 1, 1}));
  test::AddObject(scene, test::Sphere({0, 0, -5}, 1));
  test::AddObject(scene, test::Sphere({0, 0, 0}, 1));
  const Tracer tracer(scene);
  const Hit hit = tracer.Intersect({0, 0, 5}, {0, 0, -2}, {});
  EXPECT_EQ(hit.object, 1);
  EXPECT_EQ(hit.t, 2);
  EXPECT_EQ(hit.point, (Vec3d{0, 0, 1}));
  EXPECT_EQ(hit.normal, (Vec3d{0, 0, 1}));
  EXPECT_EQ(hit.side, Side::kOutside);
  EXPECT_TRUE(hit.first_on_line);
  EXPECT_FALSE(tracer.Intersect({0, 0, 5}, {0, 0, 1}, {}).IsHit());
  EXPECT_FALSE(tracer.Intersect({5, 5, 5}, {0, 0, -1}, {}).IsHit());
}

TEST(Intersect, FromInsideIsNotFirstOnTheLine) {
  Scene scene;
  test::AddMaterial(scene, test::Matte({1, 1, 1}));
  test::AddObject(scene, test::Sphere({}, 2));
  const Hit hit = Tracer(scene).Intersect({0, 0, 0}, {1, 0, 0}, {});
  EXPECT_EQ(hit.side, Side::kInside);
  EXPECT_FALSE(hit.first_on_line);
  EXPECT_EQ(hit.normal, (Vec3d{-1, 0, 0}));
}

TEST(Intersect, CoincidentSurfacesGoToTheSmallestIndex) {
  for (const Hierarchy hierarchy : {Hierarchy::kFlat, Hierarchy::kBvh}) {
    Scene scene;
    test::AddMaterial(scene, test::Matte({1, 1, 1}));
    for (int i = 0; i < 40; ++i) test::AddObject(scene, test::Box({-1, -1, -1}, {1, 1, 1}));
    EXPECT_EQ(Tracer(scene, hierarchy).Intersect({0.3, 0.2, 5}, {0, 0, -1}, {}).object, 0);
  }
}

TEST(Intersect, HierarchyStartsAboveTheLimit) {
  Scene scene;
  test::AddMaterial(scene, test::Matte({1, 1, 1}));
  for (size_t i = 0; i < kFlatLimit; ++i) test::AddObject(scene, test::Sphere({}, 1));
  EXPECT_EQ(Tracer(scene).bvh(), nullptr);
  EXPECT_NE(Tracer(scene, Hierarchy::kBvh).bvh(), nullptr);
  test::AddObject(scene, test::Sphere({}, 1));
  EXPECT_NE(Tracer(scene).bvh(), nullptr);
  EXPECT_EQ(Tracer(scene, Hierarchy::kFlat).bvh(), nullptr);
}

TEST(Intersect, EmptySceneHitsNothing) {
  const Scene scene;
  EXPECT_FALSE(Tracer(scene).Intersect({0, 0, 0}, {1, 0, 0}, {}).IsHit());
  EXPECT_FALSE(Tracer(scene, Hierarchy::kBvh).Intersect({0, 0, 0}, {1, 0, 0}, {}).IsHit());
}

// As a linetree sees it: the ray comes from infinity, also when the origin lies behind the object.
TEST(IntersectObjectLine, IsUnboundedBelow) {
  Scene scene;
  test::AddMaterial(scene, test::Matte({1, 1, 1}));
  test::AddObject(scene, test::Sphere({}, 1));
  test::AddObject(scene, test::Sphere({0, 0, 4}, 1));  // in the way, and not asked for
  const Tracer tracer(scene);
  for (const double z : {10.0, 0.0, -10.0}) {
    const Hit hit = tracer.IntersectObjectLine(0, {0, 0, z}, {0, 0, -1});
    EXPECT_EQ(hit.object, 0);
    EXPECT_EQ(hit.t, z - 1);
    EXPECT_EQ(hit.point, (Vec3d{0, 0, 1}));
    EXPECT_EQ(hit.normal, (Vec3d{0, 0, 1}));
    EXPECT_TRUE(hit.first_on_line);
  }
  EXPECT_FALSE(tracer.IntersectObjectLine(0, {2, 0, 0}, {0, 0, -1}).IsHit());
}

// A point at the origin under a light at (0, 0, 10); tests put things in between.
struct ShadowScene {
  ShadowScene() {
    scene.lights = {test::PointLight({0, 0, 10}), test::DirectionalLight({0, 0, 1})};
    opaque = test::AddMaterial(scene, test::Matte({1, 1, 1}));
    red = test::AddMaterial(scene, test::Glass({0.5, 0.25, 0}, 1.5));
    blue = test::AddMaterial(scene, test::Glass({0.1, 0.2, 0.3}, 1.2));
  }
  Tracer::Shadow Cast(int light = 0, const RayStart& start = {}) const {
    const Tracer tracer(scene);
    return tracer.CastShadow({0, 0, 0}, light, start);
  }
  Scene scene;
  int opaque, red, blue;
};

TEST(Shadow, FreeWayIsLit) {
  const auto shadow = ShadowScene().Cast();
  EXPECT_EQ(shadow.term.state, LightState::kLit);
  EXPECT_EQ(shadow.term.crossings, 0u);
  EXPECT_EQ(shadow.filter, (Rgb{1, 1, 1}));
}

TEST(Shadow, OpaqueObjectsBlock) {
  ShadowScene s;
  test::AddObject(s.scene, test::Sphere({0, 0, 5}, 1), s.red);
  test::AddObject(s.scene, test::Disc({0, 0, 3}, {0, 0, 1}, 1), s.opaque);
  const auto shadow = s.Cast();
  EXPECT_EQ(shadow.term.state, LightState::kBlocked);
  EXPECT_EQ(shadow.term.occluder, 1);
  EXPECT_EQ(shadow.filter, (Rgb{0, 0, 0}));
}

TEST(Shadow, BehindThePointLightNothingBlocksBehindADirectionalOneEverythingDoes) {
  ShadowScene s;
  test::AddObject(s.scene, test::Disc({0, 0, 10.001}, {0, 0, 1}, 1), s.opaque);
  test::AddObject(s.scene, test::Disc({0, 0, -0.001}, {0, 0, 1}, 1), s.opaque);
  EXPECT_EQ(s.Cast(0).term.state, LightState::kLit);
  EXPECT_EQ(s.Cast(1).term.state, LightState::kBlocked);
  EXPECT_EQ(s.Cast(1).term.occluder, 0);
}

// Once for every surface: a film once, a ball twice, a ball around the light once.
TEST(Shadow, TransparentSurfacesFilter) {
  ShadowScene s;
  test::AddObject(s.scene, test::Disc({0, 0, 2}, {0, 0, 1}, 1), s.red);
  EXPECT_EQ(s.Cast().filter, (Rgb{0.5, 0.25, 0}));
  test::AddObject(s.scene, test::Sphere({0, 0, 5}, 1), s.blue);
  const Rgb both = s.Cast().filter;
  EXPECT_DOUBLE_EQ(both.r, 0.5 * 0.1 * 0.1);
  EXPECT_DOUBLE_EQ(both.g, 0.25 * 0.2 * 0.2);
  EXPECT_EQ(both.b, 0);
  s.scene.objects.clear();
  test::AddObject(s.scene, test::Sphere({0, 0, 10}, 1), s.blue);
  EXPECT_EQ(s.Cast().filter, (Rgb{0.1, 0.2, 0.3}));
  EXPECT_EQ(s.Cast().term.state, LightState::kLit);
}

TEST(Shadow, BothWallsOfATubeFilter) {
  ShadowScene s;
  test::AddObject(s.scene, test::Frustum({-5, 0, 5}, {5, 0, 5}, 1, 1, true), s.blue);
  EXPECT_DOUBLE_EQ(s.Cast().filter.b, 0.3 * 0.3);
}

TEST(Shadow, CrossingsAreALabel) {
  ShadowScene film, ball, other;
  test::AddObject(film.scene, test::Disc({0, 0, 2}, {0, 0, 1}, 1), film.red);
  test::AddObject(ball.scene, test::Sphere({0, 0, 5}, 1), ball.red);
  test::AddObject(other.scene, test::Sphere({0, 0, -5}, 1), other.red);
  test::AddObject(other.scene, test::Sphere({0, 0, 5}, 1), other.red);
  const uint64_t once = film.Cast().term.crossings;
  const uint64_t twice = ball.Cast().term.crossings;
  EXPECT_NE(once, 0u);
  EXPECT_NE(twice, 0u);
  EXPECT_NE(once, twice);
  EXPECT_NE(other.Cast().term.crossings, twice) << "another object";
  EXPECT_EQ(ball.Cast().term.crossings, twice);
}

// The start's own object: never from outside, its far side from inside.
TEST(Shadow, StartsAreCombinatorial) {
  ShadowScene s;
  const int ball = test::AddObject(s.scene, test::Sphere({0, 0, 1}, 1), s.blue);
  EXPECT_EQ(s.Cast(0, {ball, 0, Side::kOutside}).filter, (Rgb{1, 1, 1}));
  EXPECT_EQ(s.Cast(0, {ball, 0, Side::kInside}).filter, (Rgb{0.1, 0.2, 0.3}));
  s.scene.materials[static_cast<size_t>(s.blue)] = test::Matte({1, 1, 1});
  EXPECT_EQ(s.Cast(0, {ball, 0, Side::kOutside}).term.state, LightState::kLit);
  EXPECT_EQ(s.Cast(0, {ball, 0, Side::kInside}).term.state, LightState::kBlocked);
}

TEST(Shadow, ObjectBlocksAsksOneObjectOnly) {
  ShadowScene s;
  const int ball = test::AddObject(s.scene, test::Sphere({0, 0, 5}, 1), s.blue);
  const int aside = test::AddObject(s.scene, test::Sphere({5, 0, 5}, 1), s.opaque);
  const int above = test::AddObject(s.scene, test::Sphere({0, 0, 15}, 1), s.opaque);
  const Tracer tracer(s.scene);
  EXPECT_TRUE(tracer.ObjectBlocks(ball, {0, 0, 0}, 0, {})) << "transparent ones count as well";
  EXPECT_FALSE(tracer.ObjectBlocks(aside, {0, 0, 0}, 0, {}));
  EXPECT_FALSE(tracer.ObjectBlocks(above, {0, 0, 0}, 0, {}));
  EXPECT_TRUE(tracer.ObjectBlocks(above, {0, 0, 0}, 1, {}));
}

}  // namespace
}  // namespace linetree
