#include "core/render/grow_trees.h"

#include <functional>
#include <variant>

namespace linetree {
namespace {

// A packet's worth: smaller samples say little.
constexpr uint32_t kLeastUses = 16;
double PriceOf(const Scene& scene, size_t object, const CellLights* parent) {
  const Shape& shape = scene.objects[object].shape;
  const bool curved =
      std::holds_alternative<SphereShape>(shape) || std::holds_alternative<FrustumShape>(shape);
  return WorkOfCell({scene.lights.size(), scene.objects.size(), curved, parent});
}

}  // namespace

SurfaceCache::Grown GrowTrees(const Scene& scene, SurfaceCache& surfaces, FramePlan& plan,
                              const Growth& growth, const ParallelLoop& loop) {
  const SurfaceCache::Thrift::Price price = [&](size_t object, const CellLights* parent) {
    return PriceOf(scene, object, parent);
  };
  const SurfaceCache::Thrift::Price least_points = [&](size_t object, const CellLights* parent) {
    if (plan.Skips(object)) return Box3::kInf;
    return price(object, parent) / (growth.horizon * plan.SavedPerPoint(object));
  };
  // Half of what is booked is left once it has been looked at.
  const std::function<bool(size_t)> may_grow = [&](size_t object) {
    const double saved = plan.SavedInAll(object) * 2 * growth.booked * kLearningHorizon;
    const bool pays = saved >= price(object, nullptr);
    if (!pays) plan.Skip(object);
    return pays;
  };
  const double most_work = plan.always() ? Box3::kInf : growth.most_work;
  return surfaces.Refine(
      growth.weight, loop,
      {plan.always() ? 1 : kLeastUses, &least_points, &may_grow, &price, most_work, growth.ahead});
}

}  // namespace linetree
