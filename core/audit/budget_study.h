// What a cache costs that is far too small for what frames use: its frames against those without.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/audit/frame_speed.h"

namespace linetree {

struct BudgetStudyOptions {
  double share = 0.05;       // of the working set that the cache may hold
  FrameSpeedOptions frames;  // its memory is for the working set to be measured
};

// Each frame's times are the medians of the repeats.
struct BudgetStudy : FlightRatios {
  uint64_t working_set_bytes = 0;  // that a large cache holds after the last view
  uint64_t memory_bytes = 0;       // the share of it
  FrameSpeed speed;
};

// The frames of `views`, one after the other. `progress` gets shares in [0, 1]; may be null.
absl::StatusOr<BudgetStudy> StudyBudget(const std::shared_ptr<const Scene>& scene,
                                        const std::vector<Camera>& views,
                                        const BudgetStudyOptions& options, WorkerPool& pool,
                                        const std::function<void(double)>& progress = nullptr);

}  // namespace linetree
