#include "core/render/grow_trees.h"

#include <functional>
#include <variant>

namespace linetree {
namespace {

// Two packets' worth: smaller samples say little.
constexpr uint32_t kLeastUses = 32;
double PriceOf(const Scene& scene, size_t object) {
  const Shape& shape = scene.objects[object].shape;
  const bool curved =
      std::holds_alternative<SphereShape>(shape) || std::holds_alternative<FrustumShape>(shape);
  return WorkOfCell(scene.lights.size(), scene.objects.size(), curved);
}

}  // namespace

uint64_t GrowTrees(const Scene& scene, SurfaceCache& surfaces, FramePlan& plan,
                   const Growth& growth, const ParallelLoop& loop) {
  const std::function<double(size_t)> least_points = [&](size_t object) {
    if (plan.Skips(object)) return Box3::kInf;
    return PriceOf(scene, object) / (growth.horizon * plan.SavedPerPoint(object));
  };
  // What is booked is one packet in kBlockPackets, and half of it once it has been looked at.
  const std::function<bool(size_t)> may_grow = [&](size_t object) {
    const bool pays =
        plan.SavedInAll(object) * 2 * kBlockPackets * kLearningHorizon >= PriceOf(scene, object);
    if (!pays) plan.Skip(object);
    return pays;
  };
  const std::function<double(size_t)> price = [&](size_t object) { return PriceOf(scene, object); };
  const double most_work = plan.always() ? Box3::kInf : growth.most_work;
  return surfaces.Refine(
      growth.weight, loop,
      {plan.always() ? 1 : kLeastUses, &least_points, &may_grow, &price, most_work});
}

}  // namespace linetree
