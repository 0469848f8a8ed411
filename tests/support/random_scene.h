// Random scenes with every shape, kind of material and kind of light.
#pragma once

#include "tests/support/random_shapes.h"

namespace linetree::test {

inline Rgb RandomRgb(Random& random, double high) {
  const double r = random.Uniform(0, high);
  const double g = random.Uniform(0, high);
  return {r, g, random.Uniform(0, high)};
}

inline Material RandomMaterial(Random& random) {
  Material material;
  material.ambient = RandomRgb(random, 0.3);
  if (random.Below(5) > 0) material.diffuse = RandomRgb(random, 0.8);
  if (random.Below(2) == 0) material.specular = RandomRgb(random, 0.5);
  material.exponent = random.Uniform(1, 40);
  if (random.Below(3) == 0) material.reflect = RandomRgb(random, 0.7);
  if (random.Below(3) == 0) {
    material.transmit = RandomRgb(random, 0.9);
    material.ior = random.Uniform(1, 1.8);
  }
  return material;
}

// `count` objects of size up to 1 in the cube [-spread, spread]^3; they may overlap.
inline Scene RandomScene(Random& random, int count, double spread) {
  Scene scene;
  scene.background = RandomRgb(random, 0.3);
  scene.ambient = RandomRgb(random, 1);
  for (int i = 0; i < 6; ++i) AddMaterial(scene, RandomMaterial(random));
  for (int i = 0; i < count; ++i) {
    const ShapeKind kind = kShapeKinds[static_cast<size_t>(i) % kShapeKinds.size()];
    const Vec3d center = random.InCube(spread);
    AddObject(scene, RandomShape(kind, random, random.Uniform(0.3, 1), center), random.Below(6));
  }
  scene.lights.push_back(PointLight(random.Direction() * (2 * spread), RandomRgb(random, 1)));
  scene.lights.push_back(PointLight(random.InCube(spread), RandomRgb(random, 1)));
  scene.lights.back().fade_distance = spread;
  scene.lights.push_back(DirectionalLight(random.Direction(), RandomRgb(random, 1)));
  return scene;
}

}  // namespace linetree::test
