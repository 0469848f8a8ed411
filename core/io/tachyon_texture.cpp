#include "core/io/tachyon_texture.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace linetree {
namespace {

// Half a step of an 8-bit picture: a smaller difference shows in none.
constexpr double kVisible = 0.5 / 255;

double Mean(const Rgb& c) { return (c.r + c.g + c.b) / 3; }

double LargestDifference(const Rgb& a, const Rgb& b) {
  double largest = 0;
  for (int i = 0; i < 3; ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

// One number for three channels, with a note of what that changes.
double GreyOf(const Rgb& c, const char* what, TachyonTexture& texture) {
  const double grey = Mean(c);
  if (LargestDifference(c, {grey, grey, grey}) > kVisible) {
    texture.differences.push_back(absl::StrCat(what, " without its colour"));
  }
  return grey;
}

}  // namespace

TachyonTexture ToTachyonTexture(const Material& material, const Rgb& scene_ambient,
                                const Rgb& tint) {
  TachyonTexture texture;
  const Rgb glow = material.ambient * scene_ambient;
  if (IsBlack(material.diffuse)) {
    texture.color = glow;
    texture.ambient = 1;
  } else {
    texture.color = material.diffuse * tint;
    texture.diffuse = 1;
    const Rgb products = glow * texture.color;
    const Rgb squares = texture.color * texture.color;
    texture.ambient = Mean(products) / Mean(squares);
  }
  if (const double off = LargestDifference(Scaled(texture.color, texture.ambient), glow);
      off > kVisible) {
    texture.differences.push_back(absl::StrFormat("ambient off by up to %.2g", off));
  }
  texture.phong = GreyOf(material.specular, "highlight", texture);
  texture.phong_size = material.exponent;
  texture.specular = GreyOf(material.reflect, "reflection", texture);
  texture.opacity = 1 - GreyOf(material.transmit, "transparency", texture);
  return texture;
}

}  // namespace linetree
