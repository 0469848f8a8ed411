#include <string>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/strings/str_cat.h"
#include "core/io/build_shape.h"
#include "core/io/canonical.h"
#include "core/io/load_scene.h"
#include "core/io/scene_source.h"
#include "core/io/validate.h"
#include "core/scene/make_shape.h"

namespace linetree {
namespace {

std::string Indexed(absl::string_view field, int i) { return absl::StrCat(field, "[", i, "]"); }

// Reads one message into one scene; each step returns the first rule that is broken.
class Builder {
 public:
  Builder(const SceneSource& source, const SceneLimits& limits)
      : source_(source), message_(source.message()), limits_(limits) {}

  absl::StatusOr<std::shared_ptr<const Scene>> Build() {
    for (auto step : {&Builder::CheckCounts, &Builder::ReadGlobals, &Builder::ReadMaterials,
                      &Builder::ReadLights, &Builder::ReadObjects, &Builder::ReadCameras}) {
      if (auto s = (this->*step)(); !s.ok()) return s;
    }
    scene_->version = VersionOf(*scene_);
    return scene_;
  }

 private:
  absl::Status CheckCounts() {
    struct Rule {
      const char* field;
      int count;
      uint64_t limit;
    };
    for (const Rule& rule : {Rule{"materials", message_.materials_size(), limits_.max_materials},
                             Rule{"lights", message_.lights_size(), limits_.max_lights},
                             Rule{"objects", message_.objects_size(), limits_.max_objects},
                             Rule{"cameras", message_.cameras_size(), limits_.max_cameras}}) {
      if (auto s = CheckLimit(source_, rule.field, static_cast<uint64_t>(rule.count), rule.limit);
          !s.ok())
        return s;
    }
    return absl::OkStatus();
  }

  absl::Status ReadGlobals() {
    if (auto s = CheckText(source_, "name", message_.name()); !s.ok()) return s;
    if (auto s = CheckText(source_, "description", message_.description()); !s.ok()) return s;
    if (auto s = CheckRgb(source_, "background", message_.background(), 0, kMaxMagnitude); !s.ok())
      return s;
    if (auto s = CheckRgb(source_, "ambient", message_.ambient(), 0, kMaxMagnitude); !s.ok())
      return s;
    scene_->name = message_.name();
    scene_->description = message_.description();
    scene_->background = ToRgb(message_.background());
    scene_->ambient = ToRgb(message_.ambient());
    if (!message_.has_white()) return absl::OkStatus();
    scene_->white = message_.white();
    // A length by its rule: finite, positive, and its reciprocal too.
    const absl::Status white = CheckLength("white", scene_->white);
    if (white.ok()) return white;
    return FieldError(source_, "white",
                      white.message().substr(absl::string_view("white: ").size()));
  }

  absl::Status ReadMaterials() {
    for (int i = 0; i < message_.materials_size(); ++i) {
      auto material = ReadMaterial(source_, Indexed("materials", i), message_.materials(i));
      if (!material.ok()) return material.status();
      if (!material_index_.try_emplace(material->name, i).second) {
        return NotUnique(Indexed("materials", i), material->name);
      }
      scene_->materials.push_back(*std::move(material));
    }
    return absl::OkStatus();
  }

  absl::Status ReadLights() {
    for (int i = 0; i < message_.lights_size(); ++i) {
      auto light = ReadLight(source_, Indexed("lights", i), message_.lights(i));
      if (!light.ok()) return light.status();
      scene_->lights.push_back(*std::move(light));
    }
    return absl::OkStatus();
  }

  absl::Status ReadCameras() {
    absl::flat_hash_set<std::string> names;
    for (int i = 0; i < message_.cameras_size(); ++i) {
      auto camera = ReadCamera(source_, Indexed("cameras", i), message_.cameras(i));
      if (!camera.ok()) return camera.status();
      if (!names.insert(camera->name).second) return NotUnique(Indexed("cameras", i), camera->name);
      scene_->cameras.push_back(*std::move(camera));
    }
    return absl::OkStatus();
  }

  absl::Status ReadObjects() {
    scene_->objects.reserve(static_cast<size_t>(message_.objects_size()));
    for (int i = 0; i < message_.objects_size(); ++i) {
      if (auto s = ReadObject(Indexed("objects", i), message_.objects(i)); !s.ok()) return s;
    }
    return absl::OkStatus();
  }

  absl::Status ReadObject(const std::string& path, const v1::Object& message) {
    if (auto s = CheckText(source_, path + ".name", message.name()); !s.ok()) return s;
    const auto material = material_index_.find(message.material());
    if (material == material_index_.end()) {
      return FieldError(
          source_, path + ".material",
          message.material().empty()
              ? "expected the name of a material"
              : absl::StrCat("expected the name of one of the scene's materials, got '",
                             message.material(), "'"));
    }
    auto shapes = BuildShapes(source_, path, message, limits_);
    if (!shapes.ok()) return shapes.status();
    for (size_t k = 0; k < shapes->size(); ++k) {
      Object object;
      object.name = message.name();
      if (shapes->size() > 1 && !object.name.empty()) absl::StrAppend(&object.name, "/", k);
      object.material = material->second;
      object.bounds = Bounds((*shapes)[k]);
      object.shape = std::move((*shapes)[k]);
      if (auto s = AddObject(path, std::move(object)); !s.ok()) return s;
    }
    return absl::OkStatus();
  }

  absl::Status AddObject(const std::string& path, Object object) {
    if (!object.name.empty() && !object_names_.insert(object.name).second) {
      return NotUnique(path, object.name);
    }
    scene_->objects.push_back(std::move(object));
    // Pieces of concave polygons count as objects.
    return CheckLimit(source_, "objects", scene_->objects.size(), limits_.max_objects);
  }

  absl::Status NotUnique(const std::string& path, absl::string_view name) {
    return FieldError(source_, path + ".name",
                      absl::StrCat("expected a name that no other has, got '", name, "' again"));
  }

  const SceneSource& source_;
  const v1::Scene& message_;
  const SceneLimits& limits_;
  std::shared_ptr<Scene> scene_ = std::make_shared<Scene>();
  absl::flat_hash_map<std::string, int> material_index_;
  absl::flat_hash_set<std::string> object_names_;
};

}  // namespace

absl::StatusOr<std::shared_ptr<const Scene>> BuildScene(const SceneSource& source,
                                                        const SceneLimits& limits) {
  return Builder(source, limits).Build();
}

}  // namespace linetree
