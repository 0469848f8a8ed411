// Small scenes that several folders' tests share.
#pragma once

#include <memory>

#include "tests/support/random.h"
#include "tests/support/scene_builder.h"

namespace linetree::test {

// A floor, a mirror, a glass ball and `spheres` random ones, two lights, one camera.
inline std::shared_ptr<const Scene> BallsOnFloor(int spheres, uint64_t seed) {
  auto scene = std::make_shared<Scene>();
  scene->name = "balls on floor";
  scene->version = "0123456789abcdef0123456789abcdef";
  scene->background = {0.1, 0.2, 0.3};
  scene->ambient = {0.2, 0.2, 0.2};
  Material matte = Matte({0.6, 0.5, 0.3});
  matte.ambient = {0.5, 0.5, 0.5};
  Material glossy = matte;
  glossy.specular = {0.4, 0.4, 0.4};
  glossy.exponent = 20;
  Material mirror = Mirror({0.7, 0.7, 0.7});
  mirror.diffuse = {0.1, 0.1, 0.1};
  scene->materials = {matte, glossy, mirror, Glass({0.8, 0.9, 0.8}, 1.4, {0.1, 0.1, 0.1})};
  scene->lights = {PointLight({4, -3, 8}, {0.5, 0.5, 0.5}),
                   PointLight({-5, -2, 7}, {0.4, 0.4, 0.4})};
  scene->objects.push_back(
      ObjectOf(Polygon({{-6, -6, 0}, {6, -6, 0}, {6, 6, 0}, {-6, 6, 0}}), 0, "floor"));
  scene->objects.push_back(
      ObjectOf(Polygon({{-3, 5, 0.5}, {3, 5, 0.5}, {3, 5, 4}, {-3, 5, 4}}), 2, "mirror"));
  scene->objects.push_back(ObjectOf(Sphere({-1.5, -2, 1}, 0.7), 3, "glass"));
  Random random(seed);
  for (int i = 0; i < spheres; ++i) {
    const double radius = random.Uniform(0.2, 0.6);
    const Vec3d at{random.Uniform(-4, 4), random.Uniform(-3, 4), radius + random.Uniform(0.01, 2)};
    scene->objects.push_back(ObjectOf(Sphere(at, radius), random.Int(0, 1)));
  }
  Camera camera;
  camera.eye = {0.5, -9, 4};
  camera.look_at = {0, 0, 1};
  camera.up = {0, 0, 1};
  scene->cameras = {camera};
  return scene;
}

}  // namespace linetree::test
