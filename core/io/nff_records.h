// From NFF's records to the messages of scene.proto: what the numbers mean.
#pragma once

#include <string>
#include <vector>

#include "core/math/vec3.h"
#include "linetree/v1/scene.pb.h"

namespace linetree {

// The `v` record.
struct NffView {
  Vec3d from{0, 0, 1}, at, up{0, 1, 0};
  double angle_deg = 45;  // full angle; pictures are square
  int width = 0, height = 0;
};
v1::Camera ToCamera(const NffView& view);

// The `f` record: Kd, Ks, Shine, T and the index of refraction.
struct NffFill {
  double r = 1, g = 1, b = 1;
  double diffuse = 1, specular = 0, shine = 0, transmit = 0, ior = 1;
  bool operator==(const NffFill&) const = default;
};
// Diffuse Kd rgb, highlight and mirror Ks (white), film T (grey), exponent Shine, no ambient. What
// scene.proto's ranges exclude but files contain is brought into them: Shine above 1e6, Ks and T
// above 1, an index of 0.
v1::Material ToMaterial(const NffFill& fill, const std::string& name);

// The `l` record. With n lights, one without a colour has the irradiance 1/sqrt(n).
struct NffLight {
  Vec3d position;
  bool has_color = false;
  double r = 1, g = 1, b = 1;
};
v1::Light ToLight(const NffLight& light, size_t light_count);

// The `c` record: an open cone, or an open cylinder when the radii are equal.
struct NffCone {
  Vec3d base, apex;
  double base_radius = 0, apex_radius = 0;
};
void SetCone(const NffCone& cone, v1::Object& object);

void SetPolygon(const std::vector<Vec3d>& vertices, v1::Object& object);
// `normals` is empty or has three elements.
void SetTriangle(const std::vector<Vec3d>& vertices, const std::vector<Vec3d>& normals,
                 v1::Object& object);

void SetVec3(const Vec3d& v, v1::Vec3& message);

}  // namespace linetree
