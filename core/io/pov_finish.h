// Materials as POV-Ray textures.
//
// POV-Ray has one colour C per texture, with a filtering part F and a transmitting part T. For a
// surface with the opacity o = 1 - F - T it computes
//   ambient * C * o, diffuse * C * o, specular (of the light's colour), reflection, and C * F + T
// for what comes through; ambient and reflection are colours, diffuse and specular are numbers.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/math/rgb.h"
#include "core/scene/material.h"

namespace linetree {

struct PovFinish {
  Rgb color{1, 1, 1};
  double filter = 0, transmit = 0;
  Rgb ambient;
  double diffuse = 0, specular = 0, roughness = 1;
  Rgb reflection;
};

// UNIMPLEMENTED with the reason when no such texture does what the material does.
absl::StatusOr<PovFinish> ToPovFinish(const Material& material);

}  // namespace linetree
