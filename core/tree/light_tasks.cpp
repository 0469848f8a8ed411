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

void CellLights::Weigh() {
  on_ = undecided_ = 0;
  is_tested_ = false;
  for (const LightList& list : lights) {
    on_ += list.knowledge == LightKnowledge::kOn ? 1 : 0;
    if (list.IsDecided()) continue;
    ++undecided_;
    is_tested_ = is_tested_ || IsTested(list);
  }
}

double CellLights::Patience() const {
  if (is_tested_) return 1;
  const double gain = undecided_ + kUnsummedCost * unsummed;
  return kAnsweredShare * (1 + (kCellPrice + kOnPrice * on_) / std::max(gain, 1.0));
}

namespace {

// Of a light that is not on.
LightTask::Kind KindOf(const LightList& list, const Scene& scene) {
  switch (list.knowledge) {
    case LightKnowledge::kOff:
    case LightKnowledge::kFacingAway:
    case LightKnowledge::kUnknown:
    case LightKnowledge::kOn:
      break;
    case LightKnowledge::kListed:
      // What several filters leave depends on the order in which they are met.
      if (std::all_of(list.candidates.begin(), list.candidates.end(),
                      [&](int32_t object) { return IsBlack(scene.MaterialOf(object).transmit); })) {
        return LightTask::Kind::kListed;
      }
      break;
  }
  return LightTask::Kind::kUnknown;
}

// Field by field: a task that has just been put together is slow to be copied as a whole.
void Set(LightTask& task, LightTask::Kind kind, uint16_t light) {
  task.kind = kind;
  task.light = light;
  task.first = task.count = 0;
}

bool MayReach(const LightList& list) {
  return list.knowledge != LightKnowledge::kOff && list.knowledge != LightKnowledge::kFacingAway;
}

}  // namespace

void CellLights::MakeTasks(const Scene& scene) {
  // Room that the cells of this thread use one after the other. Nobody can predict which lights are
  // summed, so both kinds are written and one of them is counted.
  thread_local std::vector<LightTask> rest, summed;
  rest.resize(lights.size());
  summed.resize(lights.size());
  size_t rest_count = 0, summed_count = 0;
  for (size_t i = 0; i < lights.size(); ++i) {
    const LightList& list = lights[i];
    const auto light = static_cast<uint16_t>(i);
    if (list.knowledge == LightKnowledge::kOn) {
      const auto kind = list.summed ? LightTask::Kind::kSummed : LightTask::Kind::kOn;
      Set(summed[summed_count], kind, light);
      Set(rest[rest_count], kind, light);
      summed_count += list.summed ? 1 : 0;
      rest_count += list.summed ? 0 : 1;
    } else if (MayReach(list)) {
      LightTask& task = rest[rest_count++];
      Set(task, KindOf(list, scene), light);
      if (task.kind != LightTask::Kind::kListed) continue;
      task.first = static_cast<uint32_t>(list.candidates.data() - objects.data());
      task.count = static_cast<uint32_t>(list.candidates.size());
    }
  }
  rest_of_tasks = static_cast<uint32_t>(rest_count);
  tasks.clear();
  tasks.reserve(rest_count + summed_count);
  tasks.insert(tasks.end(), rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(rest_count));
  tasks.insert(tasks.end(), summed.begin(),
               summed.begin() + static_cast<std::ptrdiff_t>(summed_count));
}

}  // namespace linetree
