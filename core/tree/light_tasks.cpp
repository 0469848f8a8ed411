#include <algorithm>
#include <span>

#include "core/tree/light_certifier.h"

namespace linetree {

namespace {

// In units of what one undecided light costs to certify: a cell itself, and every light that is on.
constexpr double kCellPrice = 2.5;
constexpr double kOnPrice = 1.0 / 13;
// And of what it costs at every point, where functions answer for it: one that is on but in no sum.
constexpr double kUnsummedCost = 0.25;
// How much less an answered light costs at every point than one whose candidates are tested. With
// the prices above: in `room` half as many cells are built, and frames are as fast.
constexpr double kAnsweredShare = 1.5;

}  // namespace

bool CellLights::IsTested(const LightList& list) const {
  if (list.knowledge == LightKnowledge::kUnknown) return true;
  if (list.knowledge != LightKnowledge::kListed) return false;
  if (!HasFunctions()) return true;
  const auto first = static_cast<size_t>(list.candidates.data() - objects.data());
  const std::span<const ShadowFunction> own =
      std::span(functions).subspan(first, list.candidates.size());
  return std::any_of(own.begin(), own.end(),
                     [](const ShadowFunction& function) { return function.pieces == 0; });
}

double CellLights::Patience() const {
  double on = 0, alone = kUnsummedCost * unsummed;
  for (const LightList& list : lights) {
    if (IsTested(list)) return 1;
    on += list.knowledge == LightKnowledge::kOn ? 1 : 0;
    alone += list.IsDecided() ? 0 : 1;
  }
  return kAnsweredShare * (1 + (kCellPrice + kOnPrice * on) / std::max(alone, 1.0));
}

void CellLights::MakeTasks(const Scene& scene) {
  const auto is_opaque = [&](int32_t object) { return IsBlack(scene.MaterialOf(object).transmit); };
  tasks.clear();
  for (size_t i = 0; i < lights.size(); ++i) {
    const LightList& list = lights[i];
    LightTask task;
    task.light = static_cast<uint16_t>(i);
    switch (list.knowledge) {
      case LightKnowledge::kOff:
      case LightKnowledge::kFacingAway:
        continue;
      case LightKnowledge::kUnknown:
        break;
      case LightKnowledge::kOn:
        task.kind = list.summed ? LightTask::Kind::kSummed : LightTask::Kind::kOn;
        break;
      case LightKnowledge::kListed:
        // What several filters leave depends on the order in which they are met.
        if (!std::all_of(list.candidates.begin(), list.candidates.end(), is_opaque)) break;
        task.kind = LightTask::Kind::kListed;
        task.first = static_cast<uint32_t>(list.candidates.data() - objects.data());
        task.count = static_cast<uint32_t>(list.candidates.size());
        break;
    }
    tasks.push_back(task);
  }
  const auto rest = std::stable_partition(tasks.begin(), tasks.end(), [](const LightTask& task) {
    return task.kind != LightTask::Kind::kSummed;
  });
  rest_of_tasks = static_cast<uint32_t>(rest - tasks.begin());
  tasks.shrink_to_fit();
}

}  // namespace linetree
