// What `linetree bench speed` measures: scenes in settings, one after the other.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/audit/speed_paths.h"
#include "core/audit/speed_study.h"
#include "core/audit/speed_sweep.h"
#include "core/audit/speed_targets.h"
#include "core/audit/stage_speed.h"

namespace linetree {

struct SpeedPlan {
  std::vector<std::string> scenes;  // files
  std::vector<std::string> made;    // KIND:OBJECTS:LIGHTS
  std::string scenes_dir = "scenes";
  SpeedSetting base;  // but for scene and name
  SpeedFlights flights;
  bool stages = false;
};

// A scene in one setting, measured.
struct SpeedRow {
  SpeedSetting setting;
  double point = 0;  // of a sweep
  std::vector<PathSpeed> paths;
  std::optional<SpeedStudy> tracers;  // packets and the scalar tracer
  std::optional<StageSpeed> stages;

  // No pixel beyond epsilon, no ray tree that differs.
  bool Holds() const;
};

using Progress = std::function<void(double)>;

// Every scene once, tracers and all; a choice of the folder's when none is given.
absl::StatusOr<std::vector<SpeedRow>> MeasureScenes(const SpeedPlan& plan,
                                                    const Progress& progress);

// Every scene at every point, which are valid; scenes worth sweeping when none is given.
absl::StatusOr<std::vector<SpeedRow>> MeasureSweep(const SpeedPlan& plan, Sweep sweep,
                                                   const std::vector<double>& points,
                                                   const Progress& progress);

// All SpeedTargets whose scene's text contains `part`.
absl::StatusOr<std::vector<TargetResult>> MeasureAllTargets(const SpeedPlan& plan,
                                                            const std::string& part,
                                                            const Progress& progress);

}  // namespace linetree
