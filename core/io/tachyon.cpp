#include "core/io/tachyon.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/io/tachyon_shape.h"
#include "core/io/tachyon_texture.h"

namespace linetree {
namespace {

// A deeper colour of the ambient light than this would tint highlights more than it is worth.
constexpr double kMinTint = 0.5;
// Relative: a step of an 8-bit picture.
constexpr double kVisibleTint = 1.0 / 255;

std::string Text(const Rgb& c) { return TachyonText(Vec3d{c.r, c.g, c.b}); }

std::string TextureName(int material) { return absl::StrCat("m", material); }

// Tachyon's x axis is up x view, the mirror image of ours, and pixel (i, j) from the bottom left is
// sampled in its upper right corner, at (i + 1) / width, (j + 1) / height of the image plane: the
// plane is turned over and moved by half a pixel.
std::string CameraText(const Camera& camera, int width, int height, int max_depth) {
  const CameraFrame frame = FrameOf(camera);
  const double across = std::tan(camera.fov_deg * std::numbers::pi / 360);
  const double down = across * height / width;
  const double dx = across / width, dy = down / height;
  return absl::StrCat(
      "Camera\n  Projection Perspective\n  Zoom 1\n  Aspectratio 1\n  Antialiasing 0\n  Raydepth ",
      max_depth, "\n  Center ", TachyonText(camera.eye), "\n  Viewdir ", TachyonText(frame.forward),
      "\n  Updir ", TachyonText(frame.up), "\n  Frustum ", TachyonText(across + dx), " ",
      TachyonText(-across + dx), " ", TachyonText(-down - dy), " ", TachyonText(down - dy),
      "\nEnd_Camera\n");
}

// 2 / (1 + (d / D)^p) = 1 / (1/2 + (d / D)^p / 2).
absl::StatusOr<std::string> AttenuationText(const Light& light) {
  if (light.fade_distance <= 0) return std::string();
  const double factor = 0.5 / std::pow(light.fade_distance, light.fade_power);
  if (light.fade_power != 1 && light.fade_power != 2) {
    return absl::UnimplementedError(absl::StrCat("Tachyon cannot express light '", light.name,
                                                 "': fade_power other than 1 or 2"));
  }
  const bool is_linear = light.fade_power == 1;
  return absl::StrCat(" Attenuation Constant 0.5 Linear ", TachyonText(is_linear ? factor : 0),
                      " Quadratic ", TachyonText(is_linear ? 0 : factor));
}

absl::StatusOr<std::string> LightText(const Light& light, const Rgb& tint) {
  const Rgb color{light.irradiance.r / tint.r, light.irradiance.g / tint.g,
                  light.irradiance.b / tint.b};
  if (light.kind == LightKind::kDirectional) {
    return absl::StrCat("Directional_Light Direction ", TachyonText(-light.to_light), " Color ",
                        Text(color), "\n");
  }
  const auto attenuation = AttenuationText(light);
  if (!attenuation.ok()) return attenuation.status();
  // A light is a ball that rays see: one without extent is never hit.
  return absl::StrCat("Light Center ", TachyonText(light.position), " Rad 0", *attenuation,
                      " Color ", Text(color), "\n");
}

std::string TextureText(int material, const TachyonTexture& t) {
  return absl::StrCat("TexDef ", TextureName(material), " Ambient ", TachyonText(t.ambient),
                      " Diffuse ", TachyonText(t.diffuse), " Specular ", TachyonText(t.specular),
                      " Opacity ", TachyonText(t.opacity), " Phong Plastic ", TachyonText(t.phong),
                      " Phong_Size ", TachyonText(t.phong_size), " Color ", Text(t.color),
                      " TexFunc 0\n");
}

// Tachyon's ambient light is white. Where ours is not, its colour goes into all diffuse colours and
// out of all lights, which leaves their products as they are and colours the ambient part. Only
// highlights, which show a light's colour alone, are off by it.
Rgb AmbientTint(const Rgb& ambient) {
  const double brightest = MaxChannel(ambient);
  for (int i = 0; i < 3; ++i) {
    if (ambient[i] < kMinTint * brightest || brightest == 0) return {1, 1, 1};
  }
  return Scaled(ambient, 1 / brightest);
}

// Whether some object's material has a property.
template <class Predicate>
bool Any(const Scene& scene, Predicate&& predicate) {
  return std::any_of(scene.objects.begin(), scene.objects.end(), [&](const Object& object) {
    return predicate(scene.materials[static_cast<size_t>(object.material)], object.shape);
  });
}

// What Tachyon does otherwise whatever the texture.
std::vector<std::string> ModelDifferences(const Scene& scene, const Rgb& tint) {
  std::vector<std::string> found;
  const bool lets_through =
      Any(scene, [](const Material& m, const Shape&) { return !IsBlack(m.transmit); });
  const bool has_highlights =
      Any(scene, [](const Material& m, const Shape&) { return !IsBlack(m.specular); });
  if (Any(scene, [](const Material& m, const Shape& shape) {
        return !IsBlack(m.transmit) && IsSolid(shape) && m.ior != 1;
      })) {
    found.push_back("no refraction: light goes straight through solids");
  }
  if (Any(scene, [](const Material& m, const Shape&) {
        return !IsBlack(m.transmit) || !IsBlack(m.reflect);
      })) {
    found.push_back("paths end at max_depth only, with the background instead of black");
  }
  const double coloured = 1 / std::min({tint.r, tint.g, tint.b}) - 1;
  if (has_highlights && coloured > kVisibleTint) {
    found.push_back(absl::StrFormat("highlights off by up to %.0f %% in colour", 100 * coloured));
  }
  if (lets_through && has_highlights) found.push_back("highlights are not filtered on their way");
  if (has_highlights && std::any_of(scene.lights.begin(), scene.lights.end(),
                                    [](const Light& l) { return l.fade_distance > 0; })) {
    found.push_back("highlights do not fade with the light's distance");
  }
  return found;
}

}  // namespace

absl::StatusOr<TachyonScene> WriteTachyon(const Scene& scene, const Camera& camera, int width,
                                          int height, const PathLimits& limits) {
  TachyonScene out;
  const Rgb tint = AmbientTint(scene.ambient);
  out.differences = ModelDifferences(scene, tint);
  out.text = absl::StrCat("Begin_Scene\nResolution ", width, " ", height, "\n",
                          CameraText(camera, width, height, limits.max_depth), "Background ",
                          Text(scene.background), "\n");
  for (const Light& light : scene.lights) {
    const auto text = LightText(light, tint);
    if (!text.ok()) return text.status();
    out.text += *text;
  }
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    const TachyonTexture texture = ToTachyonTexture(scene.materials[i], scene.ambient, tint);
    out.text += TextureText(static_cast<int>(i), texture);
    if (texture.differences.empty()) continue;
    out.differences.push_back(absl::StrCat("material '", scene.materials[i].name,
                                           "': ", absl::StrJoin(texture.differences, ", ")));
  }
  size_t approximate = 0;
  for (const Object& object : scene.objects) {
    const TachyonShape shape = ToTachyonShape(object.shape, TextureName(object.material));
    out.text += shape.text;
    if (shape.is_approximate) ++approximate;
  }
  if (approximate > 0) {
    out.differences.push_back(absl::StrCat(approximate,
                                           " curved objects are meshes of triangles with ",
                                           kTachyonSides, " sides, which take it longer"));
  }
  out.text += "End_Scene\n";
  return out;
}

}  // namespace linetree
