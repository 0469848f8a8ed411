// Where one unit in the last place decides: critical angles, tangents, terminators, highlights seen
// head-on, and cells as small as they come.
#include <gtest/gtest.h>

#include <numbers>

#include "core/cache/surface_cache.h"
#include "tests/stress/hard_rays.h"
#include "tests/stress/hard_scenes.h"
#include "tests/stress/promise.h"
#include "tests/support/scene_builder.h"

namespace linetree::stress {
namespace {

constexpr int kUlps = 24;

// A floor, a lamp, and objects on which one ulp decides, all in exact coordinates.
Scene ExactScene(double ior) {
  Scene scene;
  scene.background = {0.1, 0.2, 0.3};
  scene.ambient = {0.1, 0.1, 0.1};
  test::AddMaterial(scene, test::Matte({0.5, 0.6, 0.7}));
  test::AddMaterial(scene, test::Glass({0.9, 0.8, 0.7}, ior, {0.1, 0.1, 0.1}));
  scene.materials[0].ambient = scene.materials[1].diffuse = {0.2, 0.2, 0.2};
  scene.materials[0].specular = {0.5, 0.5, 0.5};
  test::AddObject(scene, test::Polygon({{-8, -8, -2}, {8, -8, -2}, {8, 8, -2}, {-8, 8, -2}}));
  test::AddObject(scene, test::Box({-1, -1, -1}, {1, 1, 1}), 1);
  test::AddObject(scene, test::Sphere({4, 0, 0}, 1));
  test::AddObject(scene, test::Frustum({-4, 0, -1}, {-4, 0, 1}, 1, 1));
  test::AddObject(scene, test::Frustum({0, 4, -1}, {0, 4, 1}, 1, 0));
  test::AddObject(scene, test::Sphere({0, -4, 0}, 1), 1);
  scene.lights = {test::DirectionalLight({0, 0, 1}, {0.5, 0.5, 0.5}),
                  test::PointLight({4, 0, 4}, {0.5, 0.5, 0.5}),
                  test::PointLight({1, 0, 1}, {0.2, 0.2, 0.2})};
  return scene;
}

// From the middle of the glass box to its faces, at the angle of total reflection.
void AddCritical(double ior, std::vector<Ray>& rays) {
  for (int ulps = -kUlps; ulps <= kUlps; ++ulps) {
    const double sine = Nudged(1 / ior, ulps);
    const double cosine = std::sqrt(std::max(0.0, (1 - sine) * (1 + sine)));
    for (int axis = 0; axis < 3; ++axis) {
      Vec3d d;
      d[axis] = cosine;
      d[(axis + 1) % 3] = sine;
      rays.push_back({{0, 0, 0}, d});
      rays.push_back({{0.125, 0.25, -0.5}, -d});
      d[(axis + 1) % 3] = sine * 0.6;
      d[(axis + 2) % 3] = sine * 0.8;
      rays.push_back({{0, 0, 0}, d});
    }
  }
}

// Along the sphere, the cylinder, the cone's base and the box, up to ulps; and onto the sphere's
// terminator under the light from above.
void AddTouching(std::vector<Ray>& rays) {
  for (int ulps = -kUlps; ulps <= kUlps; ++ulps) {
    const double one = Nudged(1, ulps), zero = ulps * 0x1p-53;
    for (const double x : {4.0, -4.0, 0.0}) {
      rays.push_back({{x, -8, one}, {0, 1, 0}});
      rays.push_back({{x - 8, one, 0.5}, {1, 0, 0}});
      rays.push_back({{x + one, -8, 0}, {0, 1, 0}});
      rays.push_back({{x, 0, 8}, {zero, Nudged(0.125, ulps), -1}});
    }
    rays.push_back({{8, 0, zero}, {-1, 0, 0}});
    rays.push_back({{4, 8, zero}, {0, -1, zero}});
    rays.push_back({{8, zero, 4}, {-1, 0, -1}});
    rays.push_back({{-8, 4, -one}, {1, 0, 0}});  // the cone's base
    rays.push_back({{zero, 4, 8}, {0, 0, -1}});  // its apex
  }
}

TEST(UlpsTest, CriticalAnglesTangentsAndTerminators) {
  test::Random random = RandomFor("Ulps");
  Largest largest("Ulps", 1, "of the promise");
  for (const double ior : {1.5, 4.0 / 3, 2.0, 1.0000000000000002, 2.42}) {
    const auto scene = std::make_shared<const Scene>(ExactScene(ior));
    std::vector<Ray> rays;
    AddCritical(ior, rays);
    AddTouching(rays);
    for (const Ray& ray : std::vector<Ray>(rays)) {
      for (int i = 0; i < Times(2); ++i) {
        rays.push_back({Nudged(ray.origin, random, 2), Nudged(ray.direction, random, 2)});
      }
    }
    // The shadows' borders on the floor, so that cells there are there.
    for (const Vec3d& at : {Vec3d{1, 1, -2}, Vec3d{4, 1, -2}, Vec3d{-3, 0, -2}}) {
      AddFocused(at, 1, 1500, random, rays);
    }
    ExpectPromise(scene, rays, largest);
  }
}

// n.h = 1 up to rounding: the eye and the light in one place, the surface across.
TEST(UlpsTest, HighlightsHeadOn) {
  test::Random random = RandomFor("HeadOn");
  Largest largest("Highlights head-on", 1, "of the promise");
  for (int i = 0; i < Times(4); ++i) {
    const auto scene = std::make_shared<const Scene>(Highlights(random));
    std::vector<Ray> rays;
    for (const Light& light : scene->lights) {
      for (const Object& object : scene->objects) {
        const Vec3d to = object.bounds.Center() - light.position;
        for (int k = 0; k < 60; ++k) {
          rays.push_back({light.position, Nudged(to, random, 3)});
          rays.push_back({light.position, to + random.Direction() * random.LogUniform(1e-9, 0.1)});
        }
      }
    }
    ExpectPromise(scene, rays, largest);
  }
}

// Cells under the border of a shadow are divided again and again, until they cannot be.
TEST(UlpsTest, CellsAreDividedToTheLast) {
  test::Random random = RandomFor("Deep");
  Largest largest("Deepest cells", 1, "of the promise");
  for (const double away : {0.0, 1000.0}) {
    Scene scene = ExactScene(1.5);
    const Vec3d at{away, away, 0};
    const std::vector<Vec3d> corners = {at + Vec3d{-8, -8, -2}, at + Vec3d{8, -8, -2},
                                        at + Vec3d{8, 8, -2}, at + Vec3d{-8, 8, -2}};
    scene.objects = {test::ObjectOf(test::Polygon(corners)),
                     test::ObjectOf(test::Sphere(at + Vec3d{4, 0, 0}, 1)),
                     test::ObjectOf(test::Box(at - Vec3d{1, 1, 1}, at + Vec3d{1, 1, 1}))};
    scene.lights.resize(1);
    const auto shared = std::make_shared<const Scene>(std::move(scene));
    std::vector<Ray> rays;
    for (const Vec3d& border : {Vec3d{5, 0, -2}, Vec3d{1, 0.3, -2}, Vec3d{-1, -1, -2}}) {
      for (int i = 0; i < 3000; ++i) {
        const Vec3d target = at + border + random.InCube(1) * random.LogUniform(1e-8, 1e-4);
        rays.push_back({target + Vec3d{0.3, 0.2, 0.5}, Vec3d{-0.3, -0.2, -0.5}});
      }
    }
    PromiseOptions options;
    options.rounds = 12;
    const uint64_t cells = ExpectPromise(shared, rays, largest, options) / options.bounds.size();
    std::printf("%llu cells\n", static_cast<unsigned long long>(cells));
    // Every level below the first few divides some cell.
    EXPECT_GT(cells, static_cast<uint64_t>(4 * 3 * (kMaxSurfaceDepth - 4)));
  }
}

}  // namespace
}  // namespace linetree::stress
