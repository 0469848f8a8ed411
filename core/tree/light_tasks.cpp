#include <algorithm>

#include "core/tree/light_certifier.h"

namespace linetree {

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
