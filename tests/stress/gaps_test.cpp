// Gaps of about the rounding of a crossing, where margins decide: between a light and the object
// behind it, and between a surface and the object that nearly touches it. Objects are thin, for the
// rounding of their crossings grows with the condition of their maps.
#include <gtest/gtest.h>

#include "core/scene/support.h"
#include "tests/stress/hard_rays.h"
#include "tests/stress/promise.h"
#include "tests/support/scene_builder.h"

namespace linetree::stress {
namespace {

constexpr double kFloorHalf = 4;

// An ellipsoid, a disc or a cone with half lengths of 1e-5 to 0.3, moved so that its lowest point
// along -up is `at`.
Shape ThinThing(const Vec3d& at, const Vec3d& up, test::Random& random) {
  const auto length = [&] { return random.LogUniform(1e-5, 0.3); };
  const Vec3d lengths{length(), length(), length()};
  const AffineMap turn =
      Then(Scaling(lengths), Rotation(random.Direction(), random.Uniform(0, 90)));
  const int kind = random.Below(3);
  const auto make = [&](const AffineMap& map) {
    return kind == 0   ? test::Good(MakeSphere({}, 1, map))
           : kind == 1 ? test::Good(MakeDisc({}, {0, 0, 1}, 1, map))
                       : test::Good(MakeFrustum({{0, 0, -1}, {0, 0, 1}, 1, 0, false}, map));
  };
  const Vec3d lowest = SupportPoint(make(turn), -up);
  return make(Then(turn, Translation(at - lowest)));
}

double Gap(test::Random& random) {
  return random.Below(8) == 0 ? 0 : random.LogUniform(1e-17, 1e-10);
}

Scene WithFloor() {
  Scene scene;
  scene.ambient = {0.1, 0.1, 0.1};
  scene.materials = {test::Matte({0.5, 0.5, 0.5}), test::Matte({0.1, 0.2, 0.3})};
  scene.materials[0].ambient = {0.5, 0.5, 0.5};
  const double h = kFloorHalf;
  test::AddObject(scene, test::Polygon({{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}}));
  return scene;
}

std::vector<Ray> RaysToFloor(int count, test::Random& random) {
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const Vec3d target = random.InBox({-kFloorHalf, -kFloorHalf, 0}, {kFloorHalf, kFloorHalf, 0});
    // From below, so that nothing is in the eye's way.
    const Vec3d origin = target + Vec3d{0, 0, -random.LogUniform(0.1, 1e7)} + random.InCube(0.1);
    rays.push_back({origin, target - origin});
  }
  return rays;
}

TEST(GapsTest, ObjectsJustBehindLights) {
  test::Random random = RandomFor("BehindLights");
  Largest largest("Objects just behind lights", 1, "of the promise");
  for (int i = 0; i < Times(60) && !HasFailure(); ++i) {
    auto scene = std::make_shared<Scene>(WithFloor());
    for (int k = 0; k < 8; ++k) {
      const Vec3d at = random.InBox({-3, -3, -4}, {3, 3, -1});
      // Away from all of the floor, or nearly along the segments from it.
      const Vec3d up = Unit(Vec3d{0, 0, -1} + random.InCube(0.1));
      scene->lights.push_back(test::PointLight(at, {0.1, 0.1, 0.1}));
      test::AddObject(*scene, ThinThing(at + up * Gap(random), up, random), 1);
    }
    PromiseOptions options;
    options.bounds = {0, 0.05};
    ExpectPromise(scene, RaysToFloor(1500, random), largest, options);
  }
}

TEST(GapsTest, ObjectsJustAboveSurfaces) {
  test::Random random = RandomFor("AboveSurfaces");
  Largest largest("Objects just above surfaces", 1, "of the promise");
  for (int i = 0; i < Times(60) && !HasFailure(); ++i) {
    auto scene = std::make_shared<Scene>(WithFloor());
    std::vector<Ray> rays = RaysToFloor(500, random);
    for (int k = 0; k < 4; ++k) {
      const Vec3d at = random.InBox({-3, -3, 0}, {3, 3, 0}), up{0, 0, -1};
      test::AddObject(*scene, ThinThing(at + up * Gap(random), up, random), 1);
      for (int j = 0; j < 300; ++j) {
        const Vec3d target = at + Vec3d{random.Uniform(-1, 1), random.Uniform(-1, 1), 0} *
                                      random.LogUniform(1e-9, 1);
        const Vec3d origin = target + random.Direction() * random.LogUniform(0.1, 1e7);
        rays.push_back({origin, target - origin});
      }
    }
    scene->lights = {test::DirectionalLight({1, 0, -1e-3}, {0.1, 0.1, 0.1}),
                     test::PointLight({0, 5, -1e-2}, {0.1, 0.1, 0.1}),
                     test::PointLight({1, 2, -3}, {0.1, 0.1, 0.1})};
    PromiseOptions options;
    options.bounds = {0, 0.05};
    ExpectPromise(scene, rays, largest, options);
  }
}

}  // namespace
}  // namespace linetree::stress
