// Materials as Tachyon textures.
//
// Tachyon has one colour C per texture and numbers beside it. Along a ray it computes
//   C * (ambient + diffuse * sum of lights) + phong * highlights (of the lights' colour)
//     + specular * reflection + (1 - opacity) * what comes through, straight on.
#pragma once

#include <string>
#include <vector>

#include "core/math/rgb.h"
#include "core/scene/material.h"

namespace linetree {

struct TachyonTexture {
  Rgb color;
  double ambient = 0, diffuse = 0, specular = 0, opacity = 1;
  double phong = 0, phong_size = 1;
  // What of the material the texture does not do, in words; empty when it does all.
  std::vector<std::string> differences;
};

// The nearest texture: where a number stands for three channels, the one of least squares (of the
// ambient light) or their mean. `scene_ambient` is the light that the material's ambient
// coefficients answer to; the file's lights are divided by `tint`, which the texture makes up for.
TachyonTexture ToTachyonTexture(const Material& material, const Rgb& scene_ambient,
                                const Rgb& tint);

}  // namespace linetree
