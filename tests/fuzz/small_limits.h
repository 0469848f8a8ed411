// Scenes that are quick to build and to look at.
#pragma once

#include <cmath>
#include <memory>

#include "absl/status/statusor.h"
#include "core/io/load_scene.h"
#include "core/math/check.h"
#include "core/trace/tracer.h"
#include "tests/fuzz/fuzz.h"

namespace linetree::fuzz {

inline SceneLimits SmallScenes() {
  return {.max_objects = 500,
          .max_materials = 100,
          .max_lights = 16,
          .max_cameras = 16,
          .max_polygon_vertices = 64,
          .max_half_spaces = 32,
          .max_file_bytes = 64 << 10};
}

// Builds what was parsed and traces a few rays through it: an accepted scene has no radiance that
// is not a number.
inline void BuildAndLook(const absl::StatusOr<std::unique_ptr<SceneSource>>& source) {
  if (!source.ok()) return;
  const auto scene = BuildScene(**source, SmallScenes());
  if (!scene.ok()) {
    LT_CHECK(!scene.status().message().empty());
    return;
  }
  const Tracer tracer(**scene);
  for (const Vec3d& d : {Vec3d{0, 0, -1}, Vec3d{1, 0, 0}, Vec3d{0.6, -0.8, 0}}) {
    RayCounts counts;
    const Rgb radiance = tracer.Radiance({0.1, 0.2, 3}, d, PathLimits{}, counts);
    for (int c = 0; c < 3; ++c) LT_CHECK(!std::isnan(radiance[c]));
  }
}

}  // namespace linetree::fuzz
