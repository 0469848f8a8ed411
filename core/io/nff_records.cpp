#include "core/io/nff_records.h"

#include <algorithm>
#include <cmath>

namespace linetree {
namespace {

constexpr double kMaxExponent = 1e6;  // scene.proto

void SetRgb(double r, double g, double b, v1::Rgb& message) {
  message.set_r(r);
  message.set_g(g);
  message.set_b(b);
}

}  // namespace

void SetVec3(const Vec3d& v, v1::Vec3& message) {
  message.set_x(v.x);
  message.set_y(v.y);
  message.set_z(v.z);
}

v1::Camera ToCamera(const NffView& view) {
  v1::Camera camera;
  camera.set_name("nff");
  SetVec3(view.from, *camera.mutable_eye());
  SetVec3(view.at, *camera.mutable_look_at());
  SetVec3(view.up, *camera.mutable_up());
  camera.set_fov_deg(view.angle_deg);
  return camera;
}

v1::Material ToMaterial(const NffFill& fill, const std::string& name) {
  v1::Material material;
  material.set_name(name);
  const double kd = fill.diffuse, ks = fill.specular, t = std::min(fill.transmit, 1.0);
  SetRgb(kd * fill.r, kd * fill.g, kd * fill.b, *material.mutable_diffuse());
  if (ks != 0) {
    SetRgb(ks, ks, ks, *material.mutable_specular());
    const double kr = std::min(ks, 1.0);
    SetRgb(kr, kr, kr, *material.mutable_reflect());
    material.set_exponent(std::min(fill.shine, kMaxExponent));
  }
  if (t != 0) {
    SetRgb(t, t, t, *material.mutable_transmit());
    // Films are often written with an index of 0.
    material.set_ior(fill.ior == 0 ? 1 : fill.ior);
  }
  return material;
}

v1::Light ToLight(const NffLight& light, size_t light_count) {
  v1::Light message;
  if (light.has_color) {
    SetRgb(light.r, light.g, light.b, *message.mutable_irradiance());
  } else {
    const double e = 1 / std::sqrt(static_cast<double>(light_count));
    SetRgb(e, e, e, *message.mutable_irradiance());
  }
  SetVec3(light.position, *message.mutable_point()->mutable_position());
  return message;
}

void SetCone(const NffCone& cone, v1::Object& object) {
  if (cone.base_radius == cone.apex_radius) {
    v1::Cylinder& cylinder = *object.mutable_cylinder();
    SetVec3(cone.base, *cylinder.mutable_base());
    SetVec3(cone.apex, *cylinder.mutable_top());
    cylinder.set_radius(cone.base_radius);
    cylinder.set_open(true);
    return;
  }
  v1::Cone& message = *object.mutable_cone();
  SetVec3(cone.base, *message.mutable_base());
  SetVec3(cone.apex, *message.mutable_top());
  message.set_base_radius(cone.base_radius);
  message.set_top_radius(cone.apex_radius);
  message.set_open(true);
}

void SetPolygon(const std::vector<Vec3d>& vertices, v1::Object& object) {
  v1::Polygon& polygon = *object.mutable_polygon();
  for (const Vec3d& v : vertices) SetVec3(v, *polygon.add_vertices());
}

void SetTriangle(const std::vector<Vec3d>& vertices, const std::vector<Vec3d>& normals,
                 v1::Object& object) {
  v1::Triangle& triangle = *object.mutable_triangle();
  for (const Vec3d& v : vertices) SetVec3(v, *triangle.add_vertices());
  for (const Vec3d& n : normals) SetVec3(n, *triangle.add_normals());
}

}  // namespace linetree
