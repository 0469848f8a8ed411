// How fast frames are with the cache and without: cached and classical frames of the same view in
// turn, in one process, so that what else the machine does meets both alike; and how far the cached
// ones are off.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/audit/speed_study.h"
#include "core/render/scene_host.h"

namespace linetree {

struct FrameSpeedOptions {
  int width = 512, height = 512;
  int repeats = 5;  // of which the median counts, each on a cache that starts empty
  double epsilon = 0.02;
  PathLimits limits;
  Sampling sampling{};
  Lanes lanes = Lanes::kSimd;
  CacheOptions cache{};
};

struct FrameSpeed {
  // Nanoseconds per pixel, and the median of classical / cached of the same turn; by view.
  struct Turn {
    SpeedSpread classical, cached;
    double ratio = 0;
  };
  std::vector<Turn> turns;
  // Of the last frame: shares of its pixels.
  double interpolated = 0, replayed = 0, residual = 0;
  // After the last frame: what is kept for the scene, and what the planner does about it.
  std::vector<MemoryPart> memory;
  SceneHost::Explanation explanation;
  // Of all frames of the last repeat: cells that were certified, and those that made room.
  uint64_t cells_built = 0;
  Evicted evicted;
  // Of all frames, against classical ones of the same lanes: |cached - classical| / max(classical,
  // RadianceFloor) of a pixel's worst channel, what 99.9 % of the pixels of the worst frame do not
  // exceed, and the pixels beyond epsilon.
  double largest_error = 0, p999_error = 0;
  uint64_t pixels = 0, beyond = 0;
};

// Classical by cached time of several frames: the median and the least of their own ratios, and
// that of all frames together.
struct FlightRatios {
  double median_ratio = 0, least_ratio = 0, average_ratio = 0;
};
FlightRatios RatiosOf(std::span<const FrameSpeed::Turn> turns);  // of at least one

// Adds the errors of one frame; epsilon: beyond what a pixel counts as beyond.
void AddErrors(const Frame& cached, const Frame& classical, double floor, double epsilon,
               FrameSpeed& speed);

// The frames of `views`, one after the other, of one cache that starts empty; what the scene needs
// without a cache is there before. `progress` gets shares in [0, 1]; may be null.
absl::StatusOr<FrameSpeed> StudyFrameSpeed(std::shared_ptr<const Scene> scene,
                                           const std::vector<Camera>& views,
                                           const FrameSpeedOptions& options, WorkerPool& pool,
                                           const std::function<void(double)>& progress = nullptr);

}  // namespace linetree
