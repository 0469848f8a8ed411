// Scenes built by hand, for tests. Shapes come from core/scene/make_shape.h; parameters here are
// known to be good, so a refusal ends the test program.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/math/check.h"
#include "core/scene/make_shape.h"
#include "core/scene/scene.h"

namespace linetree::test {

inline Shape Good(absl::StatusOr<Shape> shape) {
  LT_CHECK(shape.ok());
  return *std::move(shape);
}

inline Shape Sphere(const Vec3d& center, double radius) { return Good(MakeSphere(center, radius)); }
inline Shape Box(const Vec3d& min, const Vec3d& max) { return Good(MakeBox(min, max)); }
inline Shape Frustum(const Vec3d& base, const Vec3d& top, double base_radius, double top_radius,
                     bool open = false) {
  return Good(MakeFrustum({base, top, base_radius, top_radius, open}));
}
inline Shape Disc(const Vec3d& center, const Vec3d& normal, double radius) {
  return Good(MakeDisc(center, normal, radius));
}
inline Shape Polygon(const std::vector<Vec3d>& vertices) {
  return Good(MakeConvexPolygon(vertices));
}
inline Shape SmoothTriangle(const std::vector<Vec3d>& vertices, const std::vector<Vec3d>& normals) {
  return Good(MakeTriangle(vertices, normals));
}
inline Shape Polyhedron(const std::vector<HalfSpace>& half_spaces) {
  return Good(MakePolyhedron(half_spaces));
}

inline Object ObjectOf(Shape shape, int material = 0, std::string name = {}) {
  Object object;
  object.name = std::move(name);
  object.material = material;
  object.bounds = Bounds(shape);
  object.shape = std::move(shape);
  return object;
}

// Materials.
inline Material Matte(const Rgb& diffuse) {
  Material material;
  material.diffuse = diffuse;
  return material;
}
inline Material Mirror(const Rgb& reflect) {
  Material material;
  material.reflect = reflect;
  return material;
}
inline Material Glass(const Rgb& transmit, double ior, const Rgb& reflect = {}) {
  Material material;
  material.transmit = transmit;
  material.reflect = reflect;
  material.ior = ior;
  return material;
}

// Lights.
inline Light PointLight(const Vec3d& position, const Rgb& irradiance = {1, 1, 1}) {
  Light light;
  light.position = position;
  light.irradiance = irradiance;
  return light;
}
inline Light DirectionalLight(const Vec3d& to_light, const Rgb& irradiance = {1, 1, 1}) {
  Light light;
  light.kind = LightKind::kDirectional;
  light.to_light = Normalized(to_light);
  light.irradiance = irradiance;
  return light;
}

// Adds to scenes; both return the new index.
inline int AddMaterial(Scene& scene, const Material& material) {
  scene.materials.push_back(material);
  return static_cast<int>(scene.materials.size()) - 1;
}
inline int AddObject(Scene& scene, Shape shape, int material = 0) {
  scene.objects.push_back(ObjectOf(std::move(shape), material));
  return static_cast<int>(scene.objects.size()) - 1;
}

}  // namespace linetree::test
