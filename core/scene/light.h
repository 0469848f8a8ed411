// Point and directional lights.
#pragma once

#include <cmath>
#include <string>

#include "core/math/rgb.h"
#include "core/math/vec3.h"

namespace linetree {

enum class LightKind { kPoint, kDirectional };

struct Light {
  std::string name;
  LightKind kind = LightKind::kPoint;
  Rgb irradiance{1, 1, 1};   // E at normal incidence, before fall-off
  Vec3d position;            // kPoint
  Vec3d to_light{0, 0, 1};   // kDirectional: unit vector from the scene towards the light
  double fade_distance = 0;  // kPoint: 0 is no fall-off
  double fade_power = 2;
  bool operator==(const Light&) const = default;
};

// Rounding of FallOff, relative, for powers up to 8: the quotient's is raised to the power (8 of
// 2^-53), pow adds 2, sum and quotient 2; rounded up to 16.
inline constexpr double kFallOffRounding = 0x1p-49;

// Fall-off of a point light at distance d: 2 / (1 + (d/D)^p), or 1 without fade distance.
template <class S>
S FallOff(const Light& light, const S& distance) {
  using std::pow;
  if (light.fade_distance <= 0) return S(1);
  return S(2) / (S(1) + pow(distance / S(light.fade_distance), S(light.fade_power)));
}

}  // namespace linetree
