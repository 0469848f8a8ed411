// What editing a scene costs its cache: how long it takes to find the cells that a moved object
// touches, how many stay, and whether the answers are right afterwards.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "absl/status/statusor.h"
#include "core/audit/speed_study.h"
#include "core/render/scene_host.h"

namespace linetree {

struct EditStudyOptions {
  int width = 512, height = 512;
  int edits = 20;
  // Frames of an orbit before the first edit and between edits.
  int warm_frames = 12, frames_between = 1;
  double epsilon = 0.02;
  uint64_t seed = 1;  // of the spheres that move, and where to
  PathLimits limits;
};

struct EditStudy {
  size_t objects = 0;
  uint64_t cells = 0;               // before the first edit
  SpeedSpread find_ms;              // of an edit
  SpeedSpread dropped_share;        // of the cells that there are
  uint64_t pixels = 0, beyond = 0;  // after edits, of cached frames; beyond epsilon
};

// Moves one sphere after the other, by about its radius, in a scene that has some. INVALID_ARGUMENT
// for one that has none, or no camera.
absl::StatusOr<EditStudy> StudyEdits(std::shared_ptr<const Scene> scene,
                                     const EditStudyOptions& options, WorkerPool& pool,
                                     const std::function<void(double)>& progress);

}  // namespace linetree
