#include "tests/stress/hard_scenes.h"

#include <cmath>
#include <limits>

#include "tests/stress/hard_rays.h"
#include "tests/support/random_scene.h"

namespace linetree::stress {
namespace {

using test::AddMaterial;
using test::AddObject;
using test::Random;

constexpr double kDenormal = std::numeric_limits<double>::denorm_min();

test::ShapeKind AnyKind(Random& random) {
  return test::kShapeKinds[static_cast<size_t>(
      random.Below(static_cast<int>(test::kShapeKinds.size())))];
}

// Matte, glossy, mirror, glass, and glass that reflects.
Scene WithMaterials() {
  Scene scene;
  scene.background = {0.1, 0.2, 0.3};
  scene.ambient = {0.2, 0.2, 0.2};
  Material matte = test::Matte({0.6, 0.5, 0.3});
  matte.ambient = {0.5, 0.4, 0.3};
  Material glossy = matte;
  glossy.specular = {0.4, 0.3, 0.2};
  glossy.exponent = 30;
  AddMaterial(scene, matte);
  AddMaterial(scene, glossy);
  AddMaterial(scene, test::Mirror({0.8, 0.7, 0.6}));
  AddMaterial(scene, test::Glass({0.9, 0.8, 0.7}, 1.5));
  AddMaterial(scene, test::Glass({0.7, 0.8, 0.9}, 1.3, {0.2, 0.2, 0.2}));
  scene.materials[3].diffuse = scene.materials[4].diffuse = {0.1, 0.1, 0.1};
  scene.materials[2].diffuse = {0.1, 0.2, 0.1};
  return scene;
}

void AddRandomObject(Scene& scene, Random& random, double size, const Vec3d& at) {
  AddObject(scene, test::RandomShape(AnyKind(random), random, size, at), random.Below(5));
}

void AddFloor(Scene& scene, double half, double z) {
  AddObject(scene, test::Polygon(
                       {{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}}));
}

}  // namespace

Scene AllScales(Random& random) {
  Scene scene = WithMaterials();
  for (int i = 0; i < 40; ++i) {
    const double size = random.LogUniform(1e-6, 1e6);
    AddRandomObject(scene, random, size, random.Direction() * (size * random.Uniform(0.5, 3)));
  }
  for (const double far : {1e-5, 1.0, 1e6}) {
    scene.lights.push_back(test::PointLight(random.Direction() * far, {0.4, 0.5, 0.6}));
  }
  scene.lights[0].fade_distance = 1e-3;
  scene.lights.push_back(test::DirectionalLight(random.Direction(), {0.2, 0.2, 0.2}));
  return scene;
}

Scene FarAway(Random& random) {
  Scene scene = WithMaterials();
  const Vec3d center = random.Direction() * 1e6;
  for (int i = 0; i < 24; ++i) {
    AddRandomObject(scene, random, random.LogUniform(0.01, 1), center + random.InCube(2));
  }
  scene.lights.push_back(test::PointLight(center + random.InCube(3), {0.5, 0.5, 0.5}));
  scene.lights.push_back(test::PointLight({0, 0, 0}, {0.5, 0.5, 0.5}));
  scene.lights.push_back(test::DirectionalLight(random.Direction(), {0.2, 0.2, 0.2}));
  return scene;
}

Scene Touching(Random& random) {
  Scene scene = WithMaterials();
  AddFloor(scene, 8, 0);
  for (int i = 0; i < 6; ++i) {
    const double radius = i < 3 ? std::ldexp(1.0, -i) : random.Uniform(0.2, 1);
    const Vec3d at{2.0 * i - 5, -3, radius};
    AddObject(scene, test::Sphere(at, radius), random.Below(5));
    // A ball on the ball.
    AddObject(scene, test::Sphere(at + Vec3d{0, 0, 1.5 * radius}, radius / 2), random.Below(5));
  }
  for (int i = 0; i < 4; ++i) {
    const double z = 0.5 * i;
    AddObject(scene, test::Box({-1, -1, z}, {1, 1, z + 0.5}), random.Below(5));
    AddObject(scene, test::Box({1, -1, z}, {2, 1, z + 0.5}), random.Below(5));
  }
  AddObject(scene, test::Box({3, 1, 0}, {5, 3, 2}), 3);
  AddObject(scene, test::Sphere({4, 2, 1}, 1), random.Below(5));
  AddObject(scene, test::Frustum({-4, 2, 0}, {-4, 2, 2}, 0, 1), random.Below(5));
  AddObject(scene, test::Frustum({-4, 2, 2}, {-4, 2, 3}, 1, 1, true), random.Below(5));
  AddObject(scene, test::Disc({-4, 2, 3}, {0, 0, 1}, 1), 0);
  AddObject(scene, test::Polygon({{-8, 4, 0}, {8, 4, 0}, {8, 4, 4}, {-8, 4, 4}}), 2);
  scene.lights.push_back(test::PointLight({3, -5, 7}, {0.5, 0.5, 0.5}));
  scene.lights.push_back(test::PointLight(random.InBox({-7, -7, 1}, {7, 3, 6}), {0.5, 0.5, 0.5}));
  scene.lights.push_back(test::DirectionalLight({0, 0, 1}, {0.2, 0.2, 0.2}));
  return scene;
}

Scene Coincident(Random& random) {
  Scene scene = WithMaterials();
  AddFloor(scene, 4, 0);
  AddFloor(scene, 4, 0);
  scene.objects.back().material = 3;
  AddObject(scene, test::Disc({1, 1, 0}, {0, 0, 1}, 1), 1);
  AddObject(scene, test::Disc({1, 1, 0}, {0, 0, -1}, 0.5), 2);
  for (int i = 0; i < 8; ++i) {
    const Vec3d at = random.InBox({-3, -3, 0}, {3, 3, 2});
    const Shape shape = test::RandomShape(AnyKind(random), random, random.Uniform(0.3, 1), at);
    for (int twin = random.Int(2, 3); twin > 0; --twin) AddObject(scene, shape, random.Below(5));
  }
  scene.lights.push_back(test::PointLight({1, -2, 5}, {0.5, 0.5, 0.5}));
  scene.lights.push_back(test::PointLight(random.InBox({-4, -4, 0}, {4, 4, 3}), {0.5, 0.5, 0.5}));
  return scene;
}

Scene Nested(Random& random) {
  Scene scene = WithMaterials();
  AddFloor(scene, 6, -2);
  for (int i = 0; i < 5; ++i) {
    const double radius = 2 * std::ldexp(1.0, -i);
    // Concentric, and tangent to the outer one at the bottom.
    AddObject(scene, test::Sphere({-2, 0, 0}, radius), 3 + i % 2);
    AddObject(scene, test::Sphere({2, 0, radius - 2}, radius), i % 2 == 0 ? 3 : 4);
  }
  AddObject(scene, test::Box({-0.5, 3, -1}, {1.5, 5, 1}), 3);
  AddObject(scene, test::Box({-0.25, 3.25, -0.75}, {1.25, 4.75, 0.75}), 4);
  AddObject(scene, test::RandomShape(AnyKind(random), random, 0.5, {0.5, 4, 0}), 1);
  AddObject(scene, test::Frustum({0, -4, -2}, {0, -4, 1}, 1, 1), 3);
  AddObject(scene, test::Frustum({0, -4, -2}, {0, -4, 1}, 0.5, 0.5), 0);
  scene.lights.push_back(test::PointLight({0, 0, 6}, {0.5, 0.5, 0.5}));
  scene.lights.push_back(test::PointLight({-2, 0, 0.01}, {0.2, 0.2, 0.2}));
  return scene;
}

Scene LightsOnSurfaces(Random& random) {
  Scene scene = WithMaterials();
  AddFloor(scene, 4, 0);
  AddObject(scene, test::Sphere({0, 0, 1}, 1), random.Below(5));
  AddObject(scene, test::Box({2, -1, 0}, {3, 1, 2}), random.Below(5));
  for (int i = 0; i < 12; ++i) {
    AddRandomObject(scene, random, 0.5, random.InBox({-4, -4, 0.2}, {4, 4, 3}));
  }
  for (const Vec3d at : {Vec3d{1, 0, 1}, Vec3d{0, 0, 2}, Vec3d{2, -1, 2}, Vec3d{2, 0, 2},
                         Vec3d{1, 1, 0}, Vec3d{4, 4, 0}, Vec3d{9, 3, 0}, Vec3d{0, 0, 1}}) {
    scene.lights.push_back(test::PointLight(at, {0.2, 0.2, 0.2}));
  }
  for (int i = 0; i < 4; ++i) {
    const size_t object = scene.objects.size() - 1 - static_cast<size_t>(i);
    scene.lights.push_back(
        test::PointLight(PointOn(scene.objects[object], random), {0.2, 0.2, 0.2}));
    scene.lights.back().fade_distance = 1e-3;
  }
  return scene;
}

Scene AtTheTerminator(Random& random) {
  Scene scene = WithMaterials();
  AddFloor(scene, 4, 0);
  AddObject(scene, test::Box({-2, -2, 0}, {-1, -1, 1}), random.Below(5));
  AddObject(scene, test::Frustum({1, -2, 0}, {1, -2, 1}, 0.5, 0.5), random.Below(5));
  AddObject(scene, test::Sphere({1, 1, 0.5}, 0.5), random.Below(5));
  AddObject(scene, test::Polygon({{-3, 3, 0}, {3, 3, 0}, {3, 3, 2}, {-3, 3, 2}}), 1);
  for (int i = 0; i < 6; ++i) {
    AddRandomObject(scene, random, 0.5, random.InBox({-3, -3, 0}, {3, 3, 2}));
  }
  for (const int ulps : {0, 1, -1, 3}) {
    Vec3d to{1, 0, Nudged(0, ulps)};
    scene.lights.push_back(test::DirectionalLight(to, {0.3, 0.3, 0.3}));
    to = {0.25 * ulps, 1, ulps * 0x1p-52};
    scene.lights.push_back(test::DirectionalLight(to, {0.3, 0.3, 0.3}));
    scene.lights.push_back(test::PointLight({5, 0.5, ulps * 0x1p-52}, {0.3, 0.3, 0.3}));
  }
  return scene;
}

Scene Highlights(Random& random) {
  Scene scene;
  scene.ambient = {0.01, 0.01, 0.01};
  for (const double exponent : {1.0, 10.0, 100.0, 1000.0}) {
    Material shiny;
    shiny.diffuse = {0.01, 0, 0.01};
    shiny.specular = {0.9, 0.8, 1};
    shiny.exponent = exponent;
    AddMaterial(scene, shiny);
  }
  for (int i = 0; i < 12; ++i) {
    const Vec3d at = random.InCube(3);
    AddObject(scene, test::RandomShape(AnyKind(random), random, random.Uniform(0.3, 1), at), i % 4);
  }
  for (int i = 0; i < 4; ++i) {
    scene.lights.push_back(test::PointLight(random.Direction() * 6, {1, 1, 1}));
  }
  scene.lights.push_back(test::DirectionalLight({0, 0, 1}));
  return scene;
}

Scene Prisms(Random& random) {
  Scene scene = WithMaterials();
  scene.materials.clear();
  for (const double ior : {1.5, 1.3333333333333333, 2.0, 0.75, 1.0000000000000002}) {
    AddMaterial(scene, test::Glass({0.9, 0.8, 0.7}, ior, {0.1, 0.1, 0.1}));
    scene.materials.back().diffuse = {0.2, 0.2, 0.2};
  }
  AddObject(scene, test::Box({-1, -1, -1}, {1, 1, 1}), 0);
  AddObject(scene, test::Box({1, -1, -1}, {3, 1, 1}), 1);  // face to face
  AddObject(scene, test::Sphere({-3, 0, 0}, 1.5), 2);
  AddObject(scene, test::Sphere({-3, 0, 0}, 0.75), 3);
  for (int i = 0; i < 6; ++i) {
    AddObject(scene, test::RandomShape(AnyKind(random), random, 0.7, random.InCube(4)),
              random.Below(5));
  }
  scene.lights.push_back(test::PointLight({0, 0, 5}, {0.5, 0.5, 0.5}));
  scene.lights.push_back(test::PointLight({0.5, 0.25, 0}, {0.2, 0.2, 0.2}));
  return scene;
}

Scene Denormal(Random& random) {
  Scene scene = WithMaterials();
  scene.white = 1e-30;
  scene.background = {kDenormal, 0, 1e-310};
  scene.ambient = {kDenormal, 1e-300, 0};
  scene.materials[0].diffuse = {kDenormal, 1e-310, 0.5};
  scene.materials[1].specular = {1e-310, kDenormal, 0};
  scene.materials[2].reflect = {kDenormal, 1e-310, 1};
  scene.materials[3].transmit = {kDenormal, 1, 1e-310};
  for (int i = 0; i < 16; ++i) AddRandomObject(scene, random, 0.8, random.InCube(2));
  scene.lights.push_back(test::PointLight(random.InCube(3), {kDenormal, 1e-308, 0}));
  scene.lights.push_back(test::PointLight(random.InCube(3), {0, 0, 0}));
  scene.lights.push_back(test::PointLight(random.InCube(3), {1e-160, 1, 1e-320}));
  scene.lights.back().fade_distance = 1e-30;
  scene.lights.back().fade_power = 8;
  return scene;
}

Scene Crowded(Random& random) {
  Scene scene = WithMaterials();
  AddFloor(scene, 5, 0);
  for (int i = 0; i < 120; ++i) {
    AddRandomObject(scene, random, random.LogUniform(0.01, 0.5),
                    random.InBox({-4, -4, 0}, {4, 4, 3}));
  }
  scene.lights.push_back(test::PointLight({0, 0, 4}, {0.5, 0.5, 0.5}));
  scene.lights.push_back(test::DirectionalLight({1, 2, 3}, {0.5, 0.5, 0.5}));
  return scene;
}

const std::vector<NamedScene>& AllHardScenes() {
  static const std::vector<NamedScene> scenes = {{"AllScales", AllScales},
                                                 {"FarAway", FarAway},
                                                 {"Touching", Touching},
                                                 {"Coincident", Coincident},
                                                 {"Nested", Nested},
                                                 {"LightsOnSurfaces", LightsOnSurfaces},
                                                 {"AtTheTerminator", AtTheTerminator},
                                                 {"Highlights", Highlights},
                                                 {"Prisms", Prisms},
                                                 {"Denormal", Denormal},
                                                 {"Crowded", Crowded}};
  return scenes;
}

}  // namespace linetree::stress
