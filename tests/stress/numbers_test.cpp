// Scenes whose numbers leave the range in which bounds on interpolated radiance are finite, and
// rays from so far away that their hits are not where they should be. Each was a violation once.
#include <gtest/gtest.h>

#include "tests/stress/promise.h"
#include "tests/stress/stress.h"
#include "tests/support/scene_builder.h"

namespace linetree::stress {
namespace {

// Rays from one eye to points about another.
std::vector<Ray> Aimed(test::Random& random, const Vec3d& eye, const Vec3d& at, double spread) {
  std::vector<Ray> rays;
  for (int i = 0; i < Times(60'000); ++i) {
    rays.push_back({eye, Normalized(at + random.InCube(spread) - eye)});
  }
  return rays;
}

Material Glossy(const Rgb& diffuse, const Rgb& specular, const Rgb& reflect) {
  Material material = test::Matte(diffuse);
  material.specular = specular;
  material.exponent = 100;
  material.reflect = reflect;
  return material;
}

std::shared_ptr<Scene> OneObject(const Material& material, Shape shape) {
  auto scene = std::make_shared<Scene>();
  scene->ambient = {1, 1, 1};
  scene->background = {0.2, 0.3, 0.4};
  test::AddMaterial(*scene, material);
  test::AddObject(*scene, std::move(shape), 0);
  scene->lights.push_back(test::PointLight({4, 5, 6}));
  return scene;
}

const Material kMirror = Glossy({0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}, {0.3, 0.3, 0.3});

void Expect(const char* name, const std::shared_ptr<const Scene>& scene,
            const std::vector<Ray>& rays, const std::vector<double>& bounds) {
  Largest largest(name, 1, "of the promise");
  PromiseOptions options;
  options.bounds = bounds;
  options.rounds = 4;
  ExpectPromise(scene, rays, largest, options);
}

TEST(NumbersTest, AFallOffThatOverflows) {
  test::Random random = RandomFor("AFallOffThatOverflows");
  for (const double distance : {1e-18, 1e-20, 1e-30}) {
    const auto scene = OneObject(kMirror, test::Sphere({}, 1));
    scene->lights.push_back(test::PointLight({5, 5, 5}));
    scene->lights.back().fade_distance = distance;
    scene->lights.back().fade_power = 8;
    Expect("Fall-off that overflows", scene, Aimed(random, {3, 3, 4}, {}, 0.5), {1e-3, 0.1});
  }
}

TEST(NumbersTest, EyesFarAway) {
  test::Random random = RandomFor("EyesFarAway");
  for (const double away : {1e4, 1e8, 1e12, 1e14, 1e15}) {
    const auto scene = OneObject(kMirror, test::Sphere({}, 1));
    for (int i = 0; i < 25; ++i) {
      test::AddObject(*scene, test::Sphere(random.Direction() * 3.5, 0.4), 0);
    }
    Expect("Eyes far away", scene, Aimed(random, Vec3d{0.6, 0.64, 0.48} * away, {}, 0.6),
           {0, 1e-5, 1e-3});
  }
}

TEST(NumbersTest, RadianceBeyondFloats) {
  test::Random random = RandomFor("RadianceBeyondFloats");
  const auto scene =
      OneObject(Glossy({1e20, 1e20, 1e20}, {}, {0.3, 0.3, 0.3}), test::Sphere({}, 1));
  scene->lights[0].irradiance = {1e20, 1e20, 1e20};
  Expect("Radiance beyond floats", scene, Aimed(random, {3, 3, 4}, {}, 0.5), {0.1});
}

TEST(NumbersTest, SumsBelowFloats) {
  test::Random random = RandomFor("SumsBelowFloats");
  const auto scene = OneObject(Glossy({1e30, 1e30, 1e30}, {}, {}), test::Disc({}, {0, 0, 1}, 1));
  scene->ambient = {};
  scene->white = 1e-20;
  scene->lights.clear();
  for (int i = 0; i < 4; ++i) {
    scene->lights.push_back(test::PointLight({4, 5.0 + i, 6}, {3e-46, 3e-46, 3e-46}));
  }
  Expect("Sums below floats", scene, Aimed(random, {3, 3, 4}, {}, 0.5), {0.1});
}

// How far a light is above a plane comes out of the difference of large coordinates.
TEST(NumbersTest, LightsJustAboveAFarPlane) {
  test::Random random = RandomFor("LightsJustAboveAFarPlane");
  for (const double offset : {1e7, 1e8}) {
    const Vec3d at{offset, -offset, offset};
    const Vec3d normal = Normalized(Vec3d{0.3, 0.5, 0.8});
    const Vec3d along = Normalized(Cross(normal, Vec3d{1, 0, 0}));
    const auto scene = OneObject(Glossy({0.5, 0.5, 0.5}, {}, {}), test::Disc(at, normal, 1));
    scene->ambient = {};
    scene->lights.clear();
    for (int i = 0; i < 4; ++i) {
      scene->lights.push_back(
          test::PointLight(at + along * (100.0 + i) + normal * 1e-6, {1e9, 1e9, 1e9}));
    }
    Expect("Lights just above a far plane", scene, Aimed(random, at + normal * 3 + along, at, 0.5),
           {2e-4, 1e-3});
  }
}

}  // namespace
}  // namespace linetree::stress
