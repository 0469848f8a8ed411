#include "core/io/scene_edit.h"

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "core/io/validate.h"
#include "core/io/wire.h"

namespace linetree {
namespace {

// The place among `items` that `ref` means; both are objects, or both lights.
template <class Ref, class Items>
absl::StatusOr<int> Find(const Ref& ref, const Items& items, const std::string& path) {
  const auto error = [&](const auto&... parts) {
    return absl::InvalidArgumentError(absl::StrCat(path, parts...));
  };
  if (ref.which_case() == Ref::kIndex) {
    if (ref.index() < static_cast<uint32_t>(items.size())) return static_cast<int>(ref.index());
    return error(".index: expected a number below ", items.size(), ", got ", ref.index());
  }
  if (ref.which_case() != Ref::kName) return error(": expected either index or name");
  int found = -1;
  for (int i = 0; i < items.size(); ++i) {
    if (items[i].name() != ref.name()) continue;
    if (found >= 0) {
      return error(".name: expected a name that only one has, got ", Quoted(ref.name()), " of [",
                   found, "] and [", i, "]");
    }
    found = i;
  }
  if (found < 0) return error(".name: nothing has the name ", Quoted(ref.name()));
  return found;
}

void PutMaterial(const v1::Material& material, v1::Scene& scene) {
  for (v1::Material& other : *scene.mutable_materials()) {
    if (other.name() != material.name()) continue;
    other = material;
    return;
  }
  *scene.add_materials() = material;
}

// `path`: of the edit.
class Editor {
 public:
  Editor(v1::Scene& scene, const std::string& path) : scene_(scene), path_(path) {}

  absl::Status Apply(const v1::SceneEdit& edit) {
    switch (edit.edit_case()) {
      case v1::SceneEdit::kMoveObject:
        return WithObject(edit.move_object().object(), ".move_object.object", [&](int i) {
          v1::Object& object = *scene_.mutable_objects(i);
          object.mutable_transform()->MergeFrom(edit.move_object().transform());
          FoldTransform(object);  // or a scene that is moved again and again would grow
        });
      case v1::SceneEdit::kAddObject:
        *scene_.add_objects() = edit.add_object();
        return absl::OkStatus();
      case v1::SceneEdit::kReplaceObject:
        return WithObject(edit.replace_object().object(), ".replace_object.object", [&](int i) {
          *scene_.mutable_objects(i) = edit.replace_object().with();
        });
      case v1::SceneEdit::kRemoveObject:
        return WithObject(edit.remove_object(), ".remove_object",
                          [&](int i) { scene_.mutable_objects()->DeleteSubrange(i, 1); });
      case v1::SceneEdit::kSetMaterial:
        return WithObject(edit.set_material().object(), ".set_material.object", [&](int i) {
          scene_.mutable_objects(i)->set_material(edit.set_material().material());
        });
      case v1::SceneEdit::kPutMaterial:
        PutMaterial(edit.put_material(), scene_);
        return absl::OkStatus();
      default:
        return ApplyToLights(edit);
    }
  }

 private:
  absl::Status ApplyToLights(const v1::SceneEdit& edit) {
    switch (edit.edit_case()) {
      case v1::SceneEdit::kAddLight:
        *scene_.add_lights() = edit.add_light();
        return absl::OkStatus();
      case v1::SceneEdit::kReplaceLight:
        return WithLight(edit.replace_light().light(), ".replace_light.light",
                         [&](int i) { *scene_.mutable_lights(i) = edit.replace_light().with(); });
      case v1::SceneEdit::kRemoveLight:
        return WithLight(edit.remove_light(), ".remove_light",
                         [&](int i) { scene_.mutable_lights()->DeleteSubrange(i, 1); });
      default:
        return absl::InvalidArgumentError(
            absl::StrCat(path_, ": expected one of the edits, got none"));
    }
  }
  template <class Fn>
  absl::Status WithObject(const v1::ObjectRef& ref, const char* field, Fn&& change) {
    const auto index = Find(ref, scene_.objects(), absl::StrCat(path_, field));
    if (index.ok()) change(*index);
    return index.status();
  }
  template <class Fn>
  absl::Status WithLight(const v1::LightRef& ref, const char* field, Fn&& change) {
    const auto index = Find(ref, scene_.lights(), absl::StrCat(path_, field));
    if (index.ok()) change(*index);
    return index.status();
  }

  v1::Scene& scene_;
  const std::string& path_;
};

}  // namespace

absl::Status ApplyEdits(const google::protobuf::RepeatedPtrField<v1::SceneEdit>& edits,
                        v1::Scene& scene, const CancelToken* cancel) {
  for (int i = 0; i < edits.size(); ++i) {
    if (cancel != nullptr && cancel->IsCancelled()) {
      return absl::CancelledError("the call was cancelled");
    }
    const std::string path = absl::StrCat("edits[", i, "]");
    if (auto status = Editor(scene, path).Apply(edits[i]); !status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace linetree
