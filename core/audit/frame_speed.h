// How fast frames by packets are with the surface trees and without: cached and classical frames in
// turn, in one process, so that what else the machine does meets both alike; and how far the cached
// ones are off.
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/audit/speed_study.h"
#include "core/render/scene_host.h"

namespace linetree {

struct FrameSpeedOptions {
  int width = 512, height = 512;
  int repeats = 5;  // of which the median counts, each on a cache that starts empty
  int frames = 5;   // of one repeat; the first is the cold one, the last the warm one
  double epsilon = 0.02;
  PathLimits limits;
};

struct FrameSpeed {
  // Nanoseconds per pixel, and the median of classical / cached of the same turn; by frame.
  struct Turn {
    SpeedSpread classical, cached;
    double ratio = 0;
  };
  std::vector<Turn> turns;
  // Of the last frame: shares of its pixels, and what the trees hold.
  double interpolated = 0, replayed = 0, residual = 0;
  uint64_t cells = 0, bytes = 0;
  // Of all frames, against classical ones of the same lanes: |cached - classical| / max(classical,
  // RadianceFloor) and the pixels beyond epsilon.
  double largest_error = 0;
  uint64_t pixels = 0, beyond = 0;
};

absl::StatusOr<FrameSpeed> StudyFrameSpeed(std::shared_ptr<const Scene> scene, const Camera& camera,
                                           const FrameSpeedOptions& options, WorkerPool& pool);

}  // namespace linetree
