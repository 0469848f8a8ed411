#include "core/frame/plan_explanation.h"

#include "core/math/check.h"
#include "core/trace/shade.h"

namespace linetree {
namespace {

PlanReason ReasonOf(const FramePlan& plan, size_t object, const FramePlan::Known& known,
                    bool asked) {
  if (plan.always()) return PlanReason::kAlways;
  if (!known.decided) return PlanReason::kUnseen;
  if (asked) return PlanReason::kPays;
  if (!plan.Skips(object)) return PlanReason::kGrowing;
  return known.pays || known.points == 0 ? PlanReason::kTooSmall : PlanReason::kCostsMore;
}

// test(const Material&) of the objects' materials.
template <class Fn>
size_t CountObjects(const Scene& scene, Fn&& test) {
  size_t count = 0;
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    count += test(scene.MaterialOf(static_cast<int>(i))) ? 1 : 0;
  }
  return count;
}

FeatureNote Note(std::string feature, size_t count, const char* if_there, const char* if_not) {
  return {std::move(feature), count, count > 0 ? if_there : if_not};
}

}  // namespace

std::string_view WordsFor(PlanReason reason) {
  switch (reason) {
    case PlanReason::kUnseen:
      return "not seen yet: taken for a usual one";
    case PlanReason::kPays:
      return "saves work";
    case PlanReason::kGrowing:
      return "would save work: cells are still to be built";
    case PlanReason::kCostsMore:
      return "saves too little";
    case PlanReason::kTooSmall:
      return "too few points for the price of cells";
    case PlanReason::kAlways:
      return "asked whatever it costs";
  }
  return "";
}

std::vector<ObjectPlan> ExplainPlan(const FramePlan& plan, std::span<const TreeSize> trees) {
  LT_CHECK(trees.size() == plan.objects());
  std::vector<ObjectPlan> objects;
  for (size_t i = 0; i < trees.size(); ++i) {
    const FramePlan::Known known = plan.KnownOf(i);
    ObjectPlan object;
    object.object = i;
    object.asked = plan.Pays(i);
    object.reason = ReasonOf(plan, i, known, object.asked);
    object.points = known.points;
    if (known.points > 0) {
      object.tree_work = static_cast<double>(known.asked) / known.points;
      object.classical_work = static_cast<double>(known.classical) / known.points;
    }
    object.trees = trees[i];
    objects.push_back(object);
  }
  return objects;
}

std::vector<FeatureNote> ExplainFeatures(const PacketScene& scene, double sum_error) {
  const Scene& all = scene.scene();
  const auto reflects = [](const Material& m) { return !IsBlack(m.reflect); };
  const auto transmits = [](const Material& m) { return !IsBlack(m.transmit); };
  const auto shines = [](const Material& m) { return !IsBlack(m.specular); };
  const auto dull = [](const Material& m) { return !UsesLights(m); };
  std::vector<FeatureNote> notes;
  notes.push_back({"all objects", all.objects.size(),
                   scene.usable() ? "sixteen rays at a time"
                                  : "ray by ray: lengths or coefficients do not fit float"});
  notes.push_back(Note("lights", all.lights.size(), "searched or asked of surface trees",
                       "nothing to ask surface trees for"));
  notes.push_back({"diffuse sums", std::nullopt,
                   sum_error > 0 ? "used where they are within epsilon"
                                 : "left out: epsilon leaves no room beside rounding to float"});
  notes.push_back(
      Note("answering to no light", CountObjects(all, dull), "no light is looked at", "none"));
  notes.push_back(Note("glossy", CountObjects(all, shines), "highlights are exact, per pixel",
                       "no highlights are computed"));
  notes.push_back(Note("reflecting", CountObjects(all, reflects),
                       "reflected rays are collected into packets", "no reflected rays"));
  notes.push_back(Note("transmitting", CountObjects(all, transmits),
                       "refracted rays are collected into packets; shadows are filtered",
                       "no refracted rays; a shadow search ends at the first shape"));
  return notes;
}

}  // namespace linetree
