#include "core/trace/media.h"

#include <algorithm>

#include "core/trace/bvh.h"
#include "core/trace/intersect.h"

namespace linetree {
namespace {

double Volume(const Box3& box) {
  const Vec3d e = box.Extent();
  return e.x * e.y * e.z;
}

}  // namespace

Media::Media(const Scene& scene) {
  std::vector<int32_t> solids;
  std::vector<Box3> boxes;
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    const int object = static_cast<int>(i);
    if (IsBlack(scene.MaterialOf(object).transmit) || !IsSolid(scene.objects[i].shape)) continue;
    solids.push_back(object);
    boxes.push_back(scene.objects[i].bounds);
  }
  const Bvh bvh(boxes);
  const auto inner_first = [&](int32_t a, int32_t b) {
    const double volume_a = Volume(scene.objects[static_cast<size_t>(a)].bounds);
    const double volume_b = Volume(scene.objects[static_cast<size_t>(b)].bounds);
    return volume_a != volume_b ? volume_a < volume_b : a > b;
  };
  for (size_t i = 0; i < solids.size(); ++i) {
    std::vector<int32_t> around;
    bvh.ForEachOverlap([&](const Box3& box) { return box.Overlaps(boxes[i]); },
                       [&](int other) {
                         const size_t j = static_cast<size_t>(other);
                         if (j != i && boxes[j].Overlaps(boxes[i])) around.push_back(solids[j]);
                         return true;
                       });
    if (around.empty()) continue;
    std::sort(around.begin(), around.end(), inner_first);
    neighbours_.emplace(solids[i], std::move(around));
  }
}

template <class S>
double Media::IorAround(const Scene& scene, int object, const Vec3<S>& point) const {
  for (const int32_t other : Neighbours(object)) {
    if (ContainsStrictly(scene.objects[static_cast<size_t>(other)].shape, point)) {
      return scene.MaterialOf(other).ior;
    }
  }
  return 1;
}

template double Media::IorAround(const Scene&, int, const Vec3<double>&) const;
template double Media::IorAround(const Scene&, int, const Vec3<long double>&) const;

}  // namespace linetree
