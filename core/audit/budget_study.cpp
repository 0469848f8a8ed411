#include "core/audit/budget_study.h"

#include <utility>

namespace linetree {

absl::StatusOr<BudgetStudy> StudyBudget(const std::shared_ptr<const Scene>& scene,
                                        const std::vector<Camera>& views,
                                        const BudgetStudyOptions& options, WorkerPool& pool,
                                        const std::function<void(double)>& progress) {
  // The first flight counts as much as one of the others.
  const auto flights = static_cast<double>(options.frames.repeats + 1);
  const auto report = [&](double done) {
    if (progress) progress(done / flights);
  };
  BudgetStudy study;
  FrameSpeedOptions frames = options.frames;
  frames.repeats = 1;
  const auto large = StudyFrameSpeed(scene, views, frames, pool, report);
  if (!large.ok()) return large.status();
  for (const MemoryPart& part : large->memory) {
    study.working_set_bytes += part.has_cells ? part.bytes : 0;
  }
  study.memory_bytes =
      static_cast<uint64_t>(options.share * static_cast<double>(study.working_set_bytes));
  frames = options.frames;
  frames.cache.memory_bytes = study.memory_bytes;
  auto small = StudyFrameSpeed(scene, views, frames, pool, [&](double share) {
    report(1 + share * static_cast<double>(options.frames.repeats));
  });
  if (!small.ok()) return small.status();
  study.speed = *std::move(small);
  static_cast<FlightRatios&>(study) = RatiosOf(study.speed.turns);
  return study;
}

}  // namespace linetree
