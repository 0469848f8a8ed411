// A scene, validated and ready to be traced. Immutable once built: every thread may read it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/math/box3.h"
#include "core/math/rgb.h"
#include "core/scene/camera.h"
#include "core/scene/light.h"
#include "core/scene/material.h"
#include "core/scene/shape.h"

namespace linetree {

struct Object {
  std::string name;
  int material = 0;  // index into Scene::materials
  Shape shape;
  Box3 bounds;  // Bounds(shape)
};

// 128-bit hash of the scene's canonical content, 32 hexadecimal digits.
using SceneVersion = std::string;

struct Scene {
  std::string name;
  std::string description;
  SceneVersion version;
  Rgb background;
  Rgb ambient;
  double white = 1;
  std::vector<Material> materials;
  std::vector<Light> lights;
  std::vector<Object> objects;
  std::vector<Camera> cameras;  // the first is the default one

  const Material& MaterialOf(int object) const {
    return materials[static_cast<size_t>(objects[static_cast<size_t>(object)].material)];
  }
  Box3 WorldBounds() const;
  // The camera of that name, the first one for the empty name, nullptr when there is none.
  const Camera* FindCamera(const std::string& camera_name) const;
};

// Errors are measured relative to max(L, floor) with floor = white * kFloorOfWhite: a quarter of a
// code value of an 8-bit picture.
inline constexpr double kFloorOfWhite = 1.0 / 1024;
inline double RadianceFloor(const Scene& scene) { return scene.white * kFloorOfWhite; }

// Limits on what a scene may contain; whatever exceeds them is refused before it costs anything.
struct SceneLimits {
  uint64_t max_objects = 4'000'000;
  uint64_t max_materials = 1'000'000;
  uint64_t max_lights = 1024;
  uint64_t max_cameras = 4096;
  uint64_t max_polygon_vertices = 4096;
  uint64_t max_half_spaces = 256;
  uint64_t max_file_bytes = uint64_t{1} << 30;
};

}  // namespace linetree
