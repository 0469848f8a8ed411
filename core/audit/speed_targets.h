// What cached frames are to reach against classical ones by packets, row by row, and how far they
// are. A report: a row that is not met is no error.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/audit/roofline.h"
#include "core/audit/speed_paths.h"

namespace linetree {

struct SpeedTarget {
  enum class What {
    kMedian,   // ratio of the path's frames
    kLeast,    // of every single frame
    kThreads,  // cached frame with one thread by the same with two; both must be equal
  };
  std::string scene;  // KIND:OBJECTS:LIGHTS, or a file of the scenes' folder
  int width = 512, height = 512;
  int max_depth = PathLimits{}.max_depth;
  double epsilon = 0.02;
  int samples = 1;  // of every pixel
  SpeedPath path = SpeedPath::kWarm;
  What what = What::kMedian;
  double goal = 1;

  // Whether both are measured by the same flights.
  bool SharesRunWith(const SpeedTarget& other) const;
};

// All rows; those that share runs are neighbours.
std::vector<SpeedTarget> SpeedTargets();

struct TargetResult {
  SpeedTarget target;
  double measured = 0;
  uint64_t beyond = 0;  // pixels of its frames, and how far they are off
  double largest_error = 0;
  double classical_threads = 0;  // kThreads: what the second one gives classical frames
  // Of its setting. Pixels of several samples have none: some are evaluated once for all of them,
  // without their rays.
  std::optional<Roofline> roofline{};

  bool IsMet() const { return measured >= target.goal; }
};

// Measures neighbours that share a run, `targets` all of which do. `scene` is theirs.
absl::StatusOr<std::vector<TargetResult>> MeasureTargets(
    const std::vector<SpeedTarget>& targets, std::shared_ptr<const Scene> scene, int repeats,
    const SpeedFlights& flights, const std::function<void(double)>& progress);

}  // namespace linetree
