// Random rooms of flat matte faces: what frames answer as sheets, with all that may forbid it.
#pragma once

#include <memory>

#include "tests/support/random_scene.h"

namespace linetree::test {

// Matte, but for the last two: black but for its ambient light, and a clear pane.
inline constexpr int kMatteMaterials = 4;

inline void AddMatteMaterials(Scene& scene, Random& random) {
  for (int i = 0; i < kMatteMaterials; ++i) {
    Material material = Matte(RandomRgb(random, 0.9));
    material.ambient = RandomRgb(random, 0.1);
    AddMaterial(scene, material);
  }
  Material unlit;
  unlit.ambient = {0.5, 0.2, 0.1};
  AddMaterial(scene, unlit);
  AddMaterial(scene, Glass({0.7, 0.8, 0.9}, 1));
}

// A floor and walls that stand on it: boxes that share planes, or polygons that share edges.
inline void AddWalls(Scene& scene, Random& random, double half) {
  const auto material = [&] { return random.Below(kMatteMaterials); };
  const double h = half, d = half / 4;
  if (random.Below(2) == 0) {
    AddObject(scene, Box({-h, -h, -d}, {h, h, 0}), material());
    AddObject(scene, Box({-h, h, 0}, {h, h + d, h}), material());
    AddObject(scene, Box({-h - d, -h, 0}, {-h, h, h}), material());
    return;
  }
  AddObject(scene, Polygon({{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}}), material());
  AddObject(scene, Polygon({{-h, h, 0}, {h, h, 0}, {h, h, h}, {-h, h, h}}), material());
  AddObject(scene, Polygon({{-h, -h, 0}, {-h, h, 0}, {-h, h, h}, {-h, -h, h}}), material());
}

// Flat faces of every kind, and now and then a ball that throws a round shadow.
inline void AddFurniture(Scene& scene, Random& random, double half, int count) {
  constexpr ShapeKind kKinds[] = {ShapeKind::kBox,
                                  ShapeKind::kDisc,
                                  ShapeKind::kPolygon,
                                  ShapeKind::kSmoothTriangle,
                                  ShapeKind::kPolyhedron,
                                  ShapeKind::kCylinder,
                                  ShapeKind::kSmoothTriangle,
                                  ShapeKind::kSphere};
  for (int i = 0; i < count; ++i) {
    const ShapeKind kind = kKinds[random.Below(8)];
    const Vec3d center = random.InBox({-half, -half, 0}, {half, half, half});
    const int material = random.Below(6) == 0 ? kMatteMaterials : random.Below(kMatteMaterials);
    AddObject(scene, RandomShape(kind, random, random.Uniform(0.2, 0.5) * half, center), material);
  }
  // It stands on the floor, and what it is made of does not matter to who lies on the floor.
  const double x = random.Uniform(-half, half), y = random.Uniform(-half, half), s = half / 5;
  AddObject(scene, Box({x - s, y - s, 0}, {x + s, y + s, s}), random.Below(kMatteMaterials));
}

// Lights of every kind; some almost touch the floor, some lie in its plane or behind it.
inline void AddRoomLights(Scene& scene, Random& random, double half, int count) {
  for (int i = 0; i < count; ++i) {
    const Rgb strength = RandomRgb(random, 0.5);
    if (i % 5 == 4) {
      scene.lights.push_back(DirectionalLight(random.Direction(), strength));
      continue;
    }
    Vec3d at = random.InBox({-half, -half, 0.3 * half}, {half, half, half});
    if (i % 4 == 1) at.z = half * random.LogUniform(1e-6, 0.1);
    if (i % 7 == 3) at.z = random.Below(2) == 0 ? 0 : -half;
    scene.lights.push_back(PointLight(at, strength));
    if (i % 3 == 2) scene.lights.back().fade_distance = half / 2;
  }
}

// Eyes in the room, a hair above the floor, and far away.
inline void AddRoomCameras(Scene& scene, Random& random, double half) {
  const auto add = [&](const Vec3d& eye, const Vec3d& at, double fov_deg) {
    scene.cameras.push_back({"", eye, at, {0, 0, 1}, fov_deg});
  };
  const Vec3d inside = random.InBox({0, -half, 0.2 * half}, {half, 0, half});
  add(inside, random.InBox({-half, -half, 0}, {half, half, half / 2}), random.Uniform(30, 110));
  const Vec3d low{random.Uniform(0, half), -half, half * random.LogUniform(1e-4, 0.05)};
  add(low, {0, 0.5 * half, 0}, 60);
  const double far = half * random.LogUniform(10, 1e4);
  add(Vec3d{0.3, -0.7, 0.5} * far, {-0.2 * half, 0.2 * half, 0}, 60 * half / far);
}

inline std::shared_ptr<const Scene> MatteRoom(uint64_t seed) {
  Random random(seed);
  auto scene = std::make_shared<Scene>();
  scene->background = RandomRgb(random, 0.3);
  scene->ambient = random.Below(4) == 0 ? Rgb{} : Rgb{0.3, 0.3, 0.3};
  const double half = random.LogUniform(0.1, 100);
  AddMatteMaterials(*scene, random);
  AddWalls(*scene, random, half);
  AddFurniture(*scene, random, half, random.Int(1, 8));
  if (seed % 3 == 0) {
    AddObject(*scene, RandomShape(ShapeKind::kPolygon, random, half, {0, 0, 0.6 * half}),
              kMatteMaterials + 1);
  }
  AddRoomLights(*scene, random, half, random.Int(1, 16));
  AddRoomCameras(*scene, random, half);
  return scene;
}

}  // namespace linetree::test
