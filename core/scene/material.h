// What a surface does with light (DESIGN: scene and shading). All coefficients are per channel.
#pragma once

#include <string>

#include "core/math/rgb.h"

namespace linetree {

// L = ambient*A + sum_l [n.l > 0] V_l E_l (diffuse (n.l) + specular (n.h)^exponent)
//     + reflect * L(reflected) + transmit * L(refracted).
struct Material {
  std::string name;
  Rgb ambient;
  Rgb diffuse;
  Rgb specular;
  double exponent = 10;
  Rgb reflect;
  // Also filters shadow rays, once for every surface crossed. An object is opaque iff this is
  // black.
  Rgb transmit;
  double ior = 1;  // index of refraction; counts where transmit is not black
  bool operator==(const Material&) const = default;
};

}  // namespace linetree
