#include "core/scene/scene.h"

namespace linetree {

Box3 Scene::WorldBounds() const {
  Box3 box;
  for (const Object& object : objects) box.Add(object.bounds);
  return box;
}

const Camera* Scene::FindCamera(const std::string& camera_name) const {
  for (const Camera& camera : cameras) {
    if (camera_name.empty() || camera.name == camera_name) return &camera;
  }
  return nullptr;
}

}  // namespace linetree
