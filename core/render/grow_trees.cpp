#include "core/render/grow_trees.h"

#include <functional>
#include <limits>
#include <variant>

namespace linetree {
namespace {

// Two packets' worth: smaller samples say little.
constexpr uint32_t kLeastUses = 32;
// What is learnt may cost this share of the work of a frame, of about kRayWork a ray (see
// frame_plan.h).
constexpr double kLearningShare = 0.03;
constexpr double kRayWork = 30;

double PriceOf(const Scene& scene, size_t object) {
  const Shape& shape = scene.objects[object].shape;
  const bool curved =
      std::holds_alternative<SphereShape>(shape) || std::holds_alternative<FrustumShape>(shape);
  return WorkOfCell(scene.lights.size(), curved);
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
  const size_t most_cells = plan.always() ? std::numeric_limits<size_t>::max() : growth.most_cells;
  return surfaces.Refine(growth.weight, loop,
                         {plan.always() ? 1 : kLeastUses, &least_points, &may_grow, most_cells});
}

size_t CellsToLearn(const Scene& scene, size_t rays) {
  const double work = kLearningShare * kRayWork * static_cast<double>(rays);
  return static_cast<size_t>(work / WorkOfCell(scene.lights.size(), false));
}

}  // namespace linetree
