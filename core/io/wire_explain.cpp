#include "core/io/wire_explain.h"

#include <algorithm>
#include <map>
#include <vector>

#include "absl/strings/str_cat.h"

namespace linetree {
namespace {

constexpr std::pair<PlanReason, v1::PlanReason> kReasons[] = {
    {PlanReason::kUnseen, v1::PLAN_REASON_UNSEEN},
    {PlanReason::kPays, v1::PLAN_REASON_PAYS},
    {PlanReason::kGrowing, v1::PLAN_REASON_GROWING},
    {PlanReason::kCostsMore, v1::PLAN_REASON_COSTS_MORE},
    {PlanReason::kTooSmall, v1::PLAN_REASON_TOO_SMALL},
    {PlanReason::kAlways, v1::PLAN_REASON_ALWAYS}};

v1::PlanReason ReasonToWire(PlanReason reason) {
  const auto* found = std::find_if(std::begin(kReasons), std::end(kReasons),
                                   [&](const auto& pair) { return pair.first == reason; });
  return found->second;
}

}  // namespace

std::string_view WordsFor(v1::PlanReason reason) {
  for (const auto& [own, wire] : kReasons) {
    if (wire == reason) return WordsFor(own);
  }
  return WordsFor(PlanReason::kUnseen);
}

v1::ExplainReply ExplanationToWire(const Scene& scene, const SceneHost::Explanation& explanation,
                                   uint32_t max_objects) {
  v1::ExplainReply reply;
  for (const FeatureNote& note : explanation.features) {
    auto* feature = reply.add_features();
    feature->set_feature(note.feature);
    if (note.count) feature->set_count(*note.count);
    feature->set_what_frames_do(note.what_frames_do);
  }
  reply.set_decisions(explanation.decisions);
  std::map<v1::PlanReason, uint64_t> reasons;
  std::vector<const ObjectPlan*> plans;
  uint64_t asked = 0;
  for (const ObjectPlan& plan : explanation.objects) {
    ++reasons[ReasonToWire(plan.reason)];
    asked += plan.asked ? 1 : 0;
    plans.push_back(&plan);
  }
  reply.set_objects_asked(asked);
  reply.set_objects_skipped(plans.size() - asked);
  for (const auto& [reason, objects] : reasons) {
    auto* count = reply.add_reasons();
    count->set_reason(reason);
    count->set_objects(objects);
  }
  std::stable_sort(plans.begin(), plans.end(),
                   [](const ObjectPlan* a, const ObjectPlan* b) { return a->points > b->points; });
  plans.resize(std::min<size_t>(plans.size(), max_objects));
  for (const ObjectPlan* plan : plans) {
    auto* object = reply.add_objects();
    object->set_object(plan->object);
    object->set_name(scene.objects[plan->object].name);
    object->set_asked(plan->asked);
    object->set_reason(ReasonToWire(plan->reason));
    object->set_points(plan->points);
    object->set_tree_work(plan->tree_work);
    object->set_classical_work(plan->classical_work);
    object->set_cells(plan->trees.cells);
    object->set_bytes(plan->trees.bytes);
  }
  return reply;
}

absl::StatusOr<v1::ExplainReply> ExplainToWire(const v1::ExplainRequest& request,
                                               double default_error, const SceneHost& host) {
  const double error =
      request.has_max_relative_error() ? request.max_relative_error() : default_error;
  if (!(error >= 0 && error <= 1)) {
    return absl::InvalidArgumentError(
        absl::StrCat("max_relative_error: expected a number in [0, 1], got ", error));
  }
  const uint32_t objects = request.has_max_objects() ? request.max_objects() : kUsualExplained;
  if (objects < 1 || objects > kMostExplained) {
    return absl::InvalidArgumentError(
        absl::StrCat("max_objects: expected a number in [1, ", kMostExplained, "], got ", objects));
  }
  return ExplanationToWire(host.scene(), host.Explain(error), objects);
}

}  // namespace linetree
