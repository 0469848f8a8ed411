#include "core/io/pov.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "core/io/pov_finish.h"

namespace linetree {
namespace {

// 17 significant digits carry a double exactly.
std::string Text(double value) { return absl::StrFormat("%.17g", value); }
std::string Text(const Vec3d& v) {
  return absl::StrCat("<", Text(v.x), ", ", Text(v.y), ", ", Text(v.z), ">");
}
std::string Text(const Rgb& c) { return absl::StrCat("rgb ", Text(Vec3d{c.r, c.g, c.b})); }

// POV-Ray multiplies row vectors from the left: its rows are the images of the axes.
std::string MatrixText(const AffineFrame& frame) {
  std::vector<std::string> numbers;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      numbers.push_back(Text(frame.world_from_object.row[static_cast<size_t>(row)][column]));
    }
  }
  for (int i = 0; i < 3; ++i) numbers.push_back(Text(frame.center[i]));
  return absl::StrCat("matrix <", absl::StrJoin(numbers, ", "), ">");
}

std::string ShapeText(const SphereShape& s) {
  return absl::StrCat("sphere { <0, 0, 0>, 1 ", MatrixText(s.frame));
}
std::string ShapeText(const BoxShape& s) {
  return absl::StrCat("box { <-1, -1, -1>, <1, 1, 1> ", MatrixText(s.frame));
}
std::string ShapeText(const FrustumShape& s) {
  const std::string open = s.open ? "open " : "";
  if (s.base_radius == s.top_radius) {
    return absl::StrCat("cylinder { <0, 0, 0>, <0, 0, 1>, 1 ", open, MatrixText(s.frame));
  }
  return absl::StrCat("cone { <0, 0, 0>, ", Text(s.base_radius), ", <0, 0, 1>, ",
                      Text(s.top_radius), " ", open, MatrixText(s.frame));
}
std::string ShapeText(const DiscShape& s) {
  return absl::StrCat("disc { <0, 0, 0>, <0, 0, 1>, 1 ", MatrixText(s.frame));
}
std::string ShapeText(const PolygonShape& s) {
  std::vector<std::string> corners;
  for (const Vec3d& v : s.vertices) corners.push_back(Text(v));
  if (corners.size() == 3) return absl::StrCat("triangle { ", absl::StrJoin(corners, ", "));
  corners.push_back(corners.front());
  return absl::StrCat("polygon { ", corners.size(), ", ", absl::StrJoin(corners, ", "));
}
std::string ShapeText(const TriangleShape& s) {
  std::vector<std::string> parts;
  for (size_t i = 0; i < 3; ++i) {
    parts.push_back(Text(s.polygon.vertices[i]));
    parts.push_back(Text(s.normals[i]));
  }
  return absl::StrCat("smooth_triangle { ", absl::StrJoin(parts, ", "));
}
std::string ShapeText(const PolyhedronShape& s) {
  std::string text = "intersection {";
  for (const Plane& face : s.faces) {
    absl::StrAppend(&text, "\n    plane { ", Text(face.normal), ", ",
                    Text(Dot(face.normal, face.point)), " }");
  }
  const Box3 box = Bounds(Shape(s));
  // Room for POV-Ray's own tolerances.
  const Vec3d margin = box.Extent() * 0.01;
  absl::StrAppend(&text, "\n    bounded_by { box { ", Text(box.min - margin), ", ",
                  Text(box.max + margin), " } }\n   ");
  return text;
}

std::string TextureText(const PovFinish& f) {
  return absl::StrCat("texture {\n  pigment { ", Text(f.color), " filter ", Text(f.filter),
                      " transmit ", Text(f.transmit), " }\n  finish { ambient ", Text(f.ambient),
                      " diffuse ", Text(f.diffuse), " specular ", Text(f.specular), " roughness ",
                      Text(f.roughness), " reflection { ", Text(f.reflection), " } }\n}\n");
}

std::string TextureName(size_t material) { return absl::StrCat("Material", material); }

// A comment must not end, or begin a line of, what it stands in.
std::string CommentText(const std::string& text) {
  return absl::StrReplaceAll(text, {{"\n", " "}, {"\r", " "}, {"*/", "* /"}, {"/*", "/ *"}});
}

absl::StatusOr<std::string> Materials(const Scene& scene) {
  std::string text;
  std::vector<std::string> refused;
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& material = scene.materials[i];
    const auto finish = ToPovFinish(material);
    if (!finish.ok()) {
      refused.push_back(
          absl::StrCat("material '", material.name, "': ", finish.status().message()));
      continue;
    }
    absl::StrAppend(&text, "// ", CommentText(material.name), "\n#declare ", TextureName(i), " = ",
                    TextureText(*finish));
  }
  if (refused.empty()) return text;
  return absl::UnimplementedError(
      absl::StrCat("POV-Ray cannot express ", absl::StrJoin(refused, "; ")));
}

std::string LightText(const Light& light, const Box3& around) {
  if (light.kind == LightKind::kPoint) {
    const std::string fade = light.fade_distance > 0
                                 ? absl::StrCat(" fade_distance ", Text(light.fade_distance),
                                                " fade_power ", Text(light.fade_power))
                                 : "";
    return absl::StrCat("light_source { ", Text(light.position), ", ", Text(light.irradiance), fade,
                        " }\n");
  }
  // Occluders count up to the plane through the light's place: put it beyond everything.
  const Vec3d target = around.Center();
  const Vec3d place = target + light.to_light * (Length(around.Extent()) + 1);
  return absl::StrCat("light_source { ", Text(place), ", ", Text(light.irradiance),
                      " parallel point_at ", Text(target), " }\n");
}

std::string ObjectText(const Scene& scene, const Object& object) {
  const Material& material = scene.materials[static_cast<size_t>(object.material)];
  std::string text = std::visit([](const auto& s) { return ShapeText(s); }, object.shape);
  absl::StrAppend(&text, " texture { ", TextureName(static_cast<size_t>(object.material)), " }");
  if (!IsBlack(material.transmit) && IsSolid(object.shape)) {
    absl::StrAppend(&text, " interior { ior ", Text(material.ior), " }");
  }
  absl::StrAppend(&text, " }");
  if (!object.name.empty()) absl::StrAppend(&text, "  // ", CommentText(object.name));
  return text + "\n";
}

std::string CameraText(const Camera& camera, int width, int height) {
  const CameraFrame frame = FrameOf(camera);
  const double across = 2 * std::tan(camera.fov_deg * std::numbers::pi / 360);
  const double down = across * height / width;
  return absl::StrCat("camera {\n  perspective\n  location ", Text(camera.eye), "\n  direction ",
                      Text(frame.forward), "\n  right ", Text(frame.right * across), "\n  up ",
                      Text(frame.up * down), "\n}\n");
}

}  // namespace

absl::StatusOr<std::string> WritePov(const Scene& scene, const Camera& camera, int width,
                                     int height, const PathLimits& limits) {
  const auto materials = Materials(scene);
  if (!materials.ok()) return materials.status();
  Box3 around = scene.WorldBounds();
  around.Add(camera.eye);
  std::string text = absl::StrCat(
      "// ", CommentText(scene.name), ", scene version ", scene.version, "\n// povray +W", width,
      " +H", height, " +FP16 File_Gamma=1.0 Dither=off -A -D -V\n#version 3.7;\n",
      "global_settings {\n  assumed_gamma 1.0\n  max_trace_level ", limits.max_depth,
      "\n  adc_bailout ", Text(limits.min_weight), "\n  ambient_light ", Text(scene.ambient),
      "\n}\nbackground { ", Text(scene.background), " }\n", CameraText(camera, width, height));
  for (const Light& light : scene.lights) text += LightText(light, around);
  text += *materials;
  for (const Object& object : scene.objects) text += ObjectText(scene, object);
  return text;
}

}  // namespace linetree
