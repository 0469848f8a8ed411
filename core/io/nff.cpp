// NFF (Eric Haines' Neutral File Format, version 3) as a scene message.
//
// What the format leaves open, as settled here: both sides of every surface are seen, so the sign
// of a radius, which tells them apart, is dropped. `hither` and `yon` are ignored. Polygons without
// area and spheres and cones of radius 0, which generators write at the tips of things, are left
// out, and counted in the description. Polygons that are not planar, and patches, become triangles.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "core/io/load_scene.h"
#include "core/io/nff_records.h"
#include "core/io/nff_source.h"
#include "core/io/nff_tokens.h"
#include "core/io/split_polygon.h"
#include "core/scene/make_shape.h"
#include "core/scene/planar_loop.h"

namespace linetree {
namespace {

using Triangles = std::vector<std::array<int, 3>>;

// Seen along its normal, a loop that is not planar is cut into triangles like a planar one. Convex
// loops, and what cannot be cut, become a fan about vertex 0.
Triangles TrianglesOf(const std::vector<Vec3d>& vertices) {
  const auto planar = MakePlanarLoop(vertices);
  const Vec3d area = AreaVector(vertices);
  if (!(planar.ok() && planar->convex) && area != Vec3d{}) {
    auto triangles = Triangulate({vertices, Unit(area), false});
    if (triangles.ok()) return *std::move(triangles);
  }
  Triangles fan;
  for (int i = 1; i + 1 < static_cast<int>(vertices.size()); ++i) fan.push_back({0, i, i + 1});
  return fan;
}

class NffParser {
 public:
  NffParser(absl::string_view text, const std::string& file_name, const SceneLimits& limits)
      : file_name_(file_name), limits_(limits), tokens_(text, file_name) {}

  absl::StatusOr<std::unique_ptr<SceneSource>> Parse() {
    while (!tokens_.Peek().IsEnd()) {
      record_ = tokens_.Next();
      if (auto s = ReadRecord(); !s.ok()) return s;
      if (static_cast<uint64_t>(scene_.objects_size()) > limits_.max_objects) {
        return absl::ResourceExhaustedError(
            tokens_
                .Error(record_, absl::StrCat("expected at most ", limits_.max_objects, " objects"))
                .message());
      }
    }
    Finish();
    return MakeNffSource(std::move(scene_), std::move(positions_), file_name_);
  }

 private:
  using Reader = absl::Status (NffParser::*)();

  absl::Status ReadRecord() {
    static constexpr std::pair<absl::string_view, Reader> kReaders[] = {
        {"v", &NffParser::ReadView},    {"b", &NffParser::ReadBackground},
        {"l", &NffParser::ReadLight},   {"f", &NffParser::ReadFill},
        {"s", &NffParser::ReadSphere},  {"c", &NffParser::ReadCone},
        {"p", &NffParser::ReadPolygon}, {"pp", &NffParser::ReadPatch},
    };
    for (const auto& [keyword, reader] : kReaders) {
      if (record_.text == keyword) return (this->*reader)();
    }
    return tokens_.Expected("a record (v, b, l, f, s, c, p or pp)", record_);
  }

  absl::Status ReadNumber(absl::string_view what, double& value) {
    auto number = tokens_.Number(what);
    if (!number.ok()) return number.status();
    value = *number;
    return absl::OkStatus();
  }

  absl::Status ReadVec3(absl::string_view what, Vec3d& v) {
    for (int i = 0; i < 3; ++i) {
      const std::string element = absl::StrCat(std::string(1, "xyz"[i]), " of ", what);
      if (auto s = ReadNumber(element, v[i]); !s.ok()) return s;
    }
    return absl::OkStatus();
  }

  absl::Status ReadView() {
    if (scene_.cameras_size() > 0) return tokens_.Error(record_, "expected only one view (v)");
    NffView view;
    // The parts stand in a fixed order in the format's description, and in any order in files.
    for (;;) {
      const NffToken part = tokens_.Peek();
      absl::Status status;
      double ignored = 0;
      if (part.text == "from") {
        tokens_.Next();
        status = ReadVec3("from", view.from);
      } else if (part.text == "at") {
        tokens_.Next();
        status = ReadVec3("at", view.at);
      } else if (part.text == "up") {
        tokens_.Next();
        status = ReadVec3("up", view.up);
      } else if (part.text == "angle") {
        tokens_.Next();
        status = ReadNumber("the angle of view", view.angle_deg);
      } else if (part.text == "hither" || part.text == "yon") {
        tokens_.Next();
        status = ReadNumber(part.text, ignored);
      } else if (part.text == "resolution") {
        tokens_.Next();
        status = ReadResolution(view);
      } else {
        break;
      }
      if (!status.ok()) return status;
    }
    if (view.width > 0) {
      absl::StrAppend(&notes_, " Resolution ", view.width, " x ", view.height, ".");
    }
    *scene_.add_cameras() = ToCamera(view);
    positions_["cameras"].push_back(record_.position);
    return absl::OkStatus();
  }

  absl::Status ReadResolution(NffView& view) {
    constexpr uint64_t kMaxPixels = 1 << 30;
    for (int* side : {&view.width, &view.height}) {
      auto count = tokens_.Count("the resolution", kMaxPixels);
      if (!count.ok()) return count.status();
      *side = *count;
    }
    return absl::OkStatus();
  }

  absl::Status ReadBackground() {
    Vec3d rgb;
    if (auto s = ReadVec3("the background", rgb); !s.ok()) return s;
    scene_.mutable_background()->set_r(rgb.x);
    scene_.mutable_background()->set_g(rgb.y);
    scene_.mutable_background()->set_b(rgb.z);
    return absl::OkStatus();
  }

  absl::Status ReadLight() {
    NffLight light;
    if (auto s = ReadVec3("the light's position", light.position); !s.ok()) return s;
    light.has_color = NumberIn(tokens_.Peek()).has_value();
    if (light.has_color) {
      for (double* channel : {&light.r, &light.g, &light.b}) {
        if (auto s = ReadNumber("the light's colour", *channel); !s.ok()) return s;
      }
    }
    lights_.push_back(light);
    positions_["lights"].push_back(record_.position);
    return absl::OkStatus();
  }

  absl::Status ReadFill() {
    NffFill fill;
    struct Part {
      const char* what;
      double& value;
    };
    for (const Part& part :
         {Part{"red", fill.r}, Part{"green", fill.g}, Part{"blue", fill.b},
          Part{"Kd (diffuse)", fill.diffuse}, Part{"Ks (specular)", fill.specular},
          Part{"Shine", fill.shine}, Part{"T (transmittance)", fill.transmit},
          Part{"the index of refraction", fill.ior}}) {
      if (auto s = ReadNumber(part.what, part.value); !s.ok()) return s;
    }
    UseFill(fill);
    return absl::OkStatus();
  }

  // Files repeat fills before every object: equal ones are one material.
  void UseFill(const NffFill& fill) {
    const std::array<double, 8> key{fill.r,        fill.g,     fill.b,        fill.diffuse,
                                    fill.specular, fill.shine, fill.transmit, fill.ior};
    const auto [found, is_new] = fills_.try_emplace(key, scene_.materials_size());
    material_ = absl::StrCat("f", found->second);
    if (!is_new) return;
    *scene_.add_materials() = ToMaterial(fill, material_);
    positions_["materials"].push_back(record_.position);
  }

  v1::Object& AddObject() {
    // Objects before the first fill are matt white.
    if (material_.empty()) UseFill(NffFill{});
    v1::Object& object = *scene_.add_objects();
    object.set_material(material_);
    positions_["objects"].push_back(record_.position);
    return object;
  }

  absl::Status ReadSphere() {
    Vec3d center;
    double radius = 0;
    if (auto s = ReadVec3("the center of the sphere", center); !s.ok()) return s;
    if (auto s = ReadNumber("the radius of the sphere", radius); !s.ok()) return s;
    if (radius == 0) return Skip();
    v1::Sphere& sphere = *AddObject().mutable_sphere();
    SetVec3(center, *sphere.mutable_center());
    sphere.set_radius(std::abs(radius));
    return absl::OkStatus();
  }

  absl::Status ReadCone() {
    NffCone cone;
    if (auto s = ReadVec3("the base of the cone", cone.base); !s.ok()) return s;
    if (auto s = ReadNumber("the base radius", cone.base_radius); !s.ok()) return s;
    if (auto s = ReadVec3("the apex of the cone", cone.apex); !s.ok()) return s;
    if (auto s = ReadNumber("the apex radius", cone.apex_radius); !s.ok()) return s;
    cone.base_radius = std::abs(cone.base_radius);
    cone.apex_radius = std::abs(cone.apex_radius);
    if ((cone.base_radius == 0 && cone.apex_radius == 0) || cone.base == cone.apex) return Skip();
    SetCone(cone, AddObject());
    return absl::OkStatus();
  }

  absl::Status Skip() {
    ++skipped_;
    return absl::OkStatus();
  }

  absl::Status ReadVertices(std::vector<Vec3d>& vertices, std::vector<Vec3d>* normals) {
    auto count = tokens_.Count("the number of vertices", limits_.max_polygon_vertices);
    if (!count.ok()) return count.status();
    for (int i = 0; i < *count; ++i) {
      Vec3d v;
      if (auto s = ReadVec3(absl::StrCat("vertex ", i), v); !s.ok()) return s;
      vertices.push_back(v);
      if (normals == nullptr) continue;
      if (auto s = ReadVec3(absl::StrCat("normal ", i), v); !s.ok()) return s;
      normals->push_back(v);
    }
    return absl::OkStatus();
  }

  absl::Status ReadPolygon() {
    std::vector<Vec3d> vertices;
    if (auto s = ReadVertices(vertices, nullptr); !s.ok()) return s;
    if (MakePlanarLoop(vertices).ok()) {
      SetPolygon(vertices, AddObject());
      return absl::OkStatus();
    }
    return AddTriangles(vertices, {});
  }

  absl::Status ReadPatch() {
    std::vector<Vec3d> vertices, normals;
    if (auto s = ReadVertices(vertices, &normals); !s.ok()) return s;
    // A patch without usable normals is flat.
    if (std::count(normals.begin(), normals.end(), Vec3d{}) > 0) normals.clear();
    return AddTriangles(vertices, normals);
  }

  // Triangles without area are left out.
  absl::Status AddTriangles(const std::vector<Vec3d>& vertices, const std::vector<Vec3d>& normals) {
    int added = 0;
    for (const auto& triangle : TrianglesOf(vertices)) {
      std::vector<Vec3d> corners, corner_normals;
      for (int i : triangle) {
        corners.push_back(vertices[static_cast<size_t>(i)]);
        if (!normals.empty()) corner_normals.push_back(normals[static_cast<size_t>(i)]);
      }
      if (!MakePlanarLoop(corners).ok()) continue;
      SetTriangle(corners, corner_normals, AddObject());
      ++added;
    }
    return added > 0 ? absl::OkStatus() : Skip();
  }

  void Finish() {
    for (const NffLight& light : lights_) *scene_.add_lights() = ToLight(light, lights_.size());
    if (skipped_ > 0) {
      absl::StrAppend(&notes_, " ", skipped_, " degenerate primitives were left out.");
    }
    scene_.set_description(absl::StrCat("Imported from NFF.", notes_));
  }

  std::string file_name_;
  SceneLimits limits_;
  NffTokens tokens_;
  NffToken record_;  // the keyword of the record that is being read
  v1::Scene scene_;
  NffPositions positions_;
  std::vector<NffLight> lights_;
  absl::flat_hash_map<std::array<double, 8>, int> fills_;
  std::string material_;  // name of the current fill
  std::string notes_;
  int skipped_ = 0;
};

}  // namespace

absl::StatusOr<std::unique_ptr<SceneSource>> ParseNff(std::string_view text,
                                                      const std::string& file_name,
                                                      const SceneLimits& limits) {
  if (text.size() > limits.max_file_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat(
        file_name, ": expected at most ", limits.max_file_bytes, " bytes, got ", text.size()));
  }
  return NffParser({text.data(), text.size()}, file_name, limits).Parse();
}

}  // namespace linetree
