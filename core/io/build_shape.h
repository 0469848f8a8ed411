// From one object of a scene message to the shapes it stands for.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/io/load_scene.h"
#include "core/scene/shape.h"

namespace linetree {

// One shape, or the convex pieces of a concave polygon. `path` is the object's, "objects[3]".
absl::StatusOr<std::vector<Shape>> BuildShapes(const SceneSource& source, const std::string& path,
                                               const v1::Object& message,
                                               const SceneLimits& limits);

}  // namespace linetree
