// Every pixel of the frames of one camera path against the classical ones, and how much searching
// of the scene the certified trees save.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/render/scene_host.h"

namespace linetree {

struct FrameStudyOptions {
  int side = 512;
  int frames = 30;
  std::vector<double> epsilons = {0, 0.02, 0.1, 0.25};
  Lanes lanes = Lanes::kScalar;
};

// All frames of one path at one epsilon, on one cache that starts empty.
struct FrameStudyRow {
  double epsilon = 0;
  uint64_t pixels = 0;
  uint64_t unequal = 0;      // pixels that differ from the classical frame's in any bit
  uint64_t violations = 0;   // pixels with a channel beyond epsilon (see compare.h on float)
  double largest_error = 0;  // relative to what epsilon allows; 0 at epsilon 0
  uint64_t interpolated = 0, replayed = 0, residual = 0;
  // Searches of the whole scene relative to the classical tracer's: over the whole path, and for
  // its first view again at the end.
  double path_searches = 0, warm_searches = 0;
};

// The cameras of a path: `frames` positions around what the camera looks at, 1 degree apart; the
// given one is at 0 degrees.
std::vector<Camera> OrbitOf(const Camera& camera, int frames, int first_deg = 0);

absl::StatusOr<std::vector<FrameStudyRow>> StudyFrames(std::shared_ptr<const Scene> scene,
                                                       const std::vector<Camera>& path,
                                                       const FrameStudyOptions& options,
                                                       WorkerPool& pool,
                                                       const std::function<void(double)>& progress);

}  // namespace linetree
