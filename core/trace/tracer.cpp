#include "core/trace/tracer.h"

#include <algorithm>

#include "absl/container/inlined_vector.h"
#include "core/trace/intersect.h"

namespace linetree {
namespace {

// The segment or half line from a point to a light: o + t d, 0 < t < t_max.
template <class S>
struct LightSegment {
  Vec3<S> direction;
  S t_max;
};
template <class S>
LightSegment<S> SegmentTo(const Light& light, const Vec3<S>& point) {
  if (light.kind == LightKind::kDirectional) {
    return {CastVec3<S>(light.to_light), std::numeric_limits<S>::infinity()};
  }
  return {-(point - light.position), S(1)};
}

template <class S>
int CountBefore(const Crossings<S>& crossings, const S& t_max) {
  return static_cast<int>(std::count_if(crossings.begin(), crossings.end(),
                                        [&](const auto& crossing) { return crossing.t < t_max; }));
}

// A transparent object between a point and a light.
struct Filter {
  int object = kNoObject;
  int crossings = 0;
};
// More than this many transparent objects in one shadow cost an allocation.
constexpr size_t kUsualFilters = 8;
using Filters = absl::InlinedVector<Filter, kUsualFilters>;

// splitmix64's finaliser.
uint64_t Mix(uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

uint64_t HashOf(const Filters& filters) {
  uint64_t sum = 0;
  for (const Filter& filter : filters) {
    sum += Mix(static_cast<uint64_t>(filter.object) * 4 + static_cast<uint64_t>(filter.crossings));
  }
  return filters.empty() || sum != 0 ? sum : 1;
}

// Multiplied in the order of objects, not of the search: the product's bits depend on the order.
template <class S>
RgbOf<S> ProductOf(Filters& filters, const Scene& scene) {
  std::sort(filters.begin(), filters.end(),
            [](const Filter& a, const Filter& b) { return a.object < b.object; });
  RgbOf<S> product{S(1), S(1), S(1)};
  for (const Filter& filter : filters) {
    for (int i = 0; i < filter.crossings; ++i) {
      product = product * scene.MaterialOf(filter.object).transmit;
    }
  }
  return product;
}

std::unique_ptr<const Bvh> MakeHierarchy(const Scene& scene, Hierarchy hierarchy) {
  const bool flat = hierarchy == Hierarchy::kFlat ||
                    (hierarchy == Hierarchy::kAuto && scene.objects.size() <= kFlatLimit);
  if (flat) return nullptr;
  std::vector<Box3> boxes;
  boxes.reserve(scene.objects.size());
  for (const Object& object : scene.objects) boxes.push_back(object.bounds);
  return std::make_unique<const Bvh>(boxes);
}

}  // namespace

struct ShadowFilters {
  Filters list;
};

template <class S>
TracerOf<S>::TracerOf(const Scene& scene, Hierarchy hierarchy)
    : scene_(&scene), media_(scene), bvh_(MakeHierarchy(scene, hierarchy)) {}

template <class S>
template <class ObjectFn>
void TracerOf<S>::ForEachAlong(const Vec3<S>& origin, const Vec3<S>& direction, const S& t_max,
                               ObjectFn&& fn) const {
  if (bvh_) {
    bvh_->ForEachAlong(origin, direction, t_max, fn);
    return;
  }
  const int count = static_cast<int>(scene_->objects.size());
  for (int object = 0; object < count; ++object) {
    if (!fn(object)) return;
  }
}

template <class S>
void TracerOf<S>::Approach(int object, const Vec3<S>& origin, const Vec3<S>& direction,
                           const RayStart& start, S& nearest, HitOf<S>& hit) const {
  for (const Crossing<S>& crossing :
       RayCrossings(ShapeOf(object), object, origin, direction, start)) {
    const bool nearer = crossing.t < nearest || (crossing.t == nearest && object < hit.object);
    if (!nearer) continue;
    nearest = crossing.t;
    hit.object = object;
    hit.face = crossing.face;
    hit.side = crossing.side;
    hit.first_on_line = crossing.first_on_line;
  }
}

template <class S>
void TracerOf<S>::Complete(const Vec3<S>& origin, const Vec3<S>& direction, const S& t,
                           HitOf<S>& hit) const {
  hit.t = t;
  hit.point = origin + direction * t;
  hit.normal = FacingNormal(ShapeOf(hit.object), hit.face, hit.point, direction);
}

template <class S>
HitOf<S> TracerOf<S>::Intersect(const Vec3<S>& origin, const Vec3<S>& direction,
                                const RayStart& start) const {
  HitOf<S> hit;
  S nearest = std::numeric_limits<S>::infinity();
  ForEachAlong(origin, direction, nearest, [&](int object) {
    Approach(object, origin, direction, start, nearest, hit);
    return true;
  });
  if (hit.IsHit()) Complete(origin, direction, nearest, hit);
  return hit;
}

template <class S>
HitOf<S> TracerOf<S>::IntersectAmong(std::span<const int32_t> objects, const Vec3<S>& origin,
                                     const Vec3<S>& direction, const RayStart& start) const {
  HitOf<S> hit;
  S nearest = std::numeric_limits<S>::infinity();
  for (const int32_t object : objects) {
    Approach(object, origin, direction, start, nearest, hit);
  }
  if (hit.IsHit()) Complete(origin, direction, nearest, hit);
  return hit;
}

template <class S>
HitOf<S> TracerOf<S>::IntersectObjectLine(int object, const Vec3<S>& origin,
                                          const Vec3<S>& direction) const {
  HitOf<S> hit;
  const Crossings<S> crossings = LineCrossings(ShapeOf(object), origin, direction);
  if (crossings.count == 0) return hit;
  const Crossing<S>& first = crossings.at[0];
  hit.object = object;
  hit.face = first.face;
  hit.side = first.side;
  Complete(origin, direction, first.t, hit);
  return hit;
}

template <class S>
bool TracerOf<S>::AddOccluder(int object, const Vec3<S>& point, const Vec3<S>& direction,
                              const S& t_max, const RayStart& start, Shadow& shadow,
                              ShadowFilters& filters) const {
  const int crossings =
      CountBefore(RayCrossings(ShapeOf(object), object, point, direction, start), t_max);
  if (crossings == 0) return true;
  if (IsBlack(scene_->MaterialOf(object).transmit)) {
    shadow.term.state = LightState::kBlocked;
    shadow.term.occluder = object;
    return false;
  }
  filters.list.push_back({object, crossings});
  return true;
}

template <class S>
typename TracerOf<S>::Shadow TracerOf<S>::CastShadow(const Vec3<S>& point, int light,
                                                     const RayStart& start) const {
  const LightSegment<S> segment = SegmentTo(scene_->lights[static_cast<size_t>(light)], point);
  Shadow shadow;
  shadow.term.state = LightState::kLit;
  ShadowFilters filters;
  ForEachAlong(point, segment.direction, segment.t_max, [&](int object) {
    return AddOccluder(object, point, segment.direction, segment.t_max, start, shadow, filters);
  });
  if (shadow.term.state == LightState::kBlocked) return shadow;
  shadow.term.crossings = HashOf(filters.list);
  shadow.filter = ProductOf<S>(filters.list, *scene_);
  return shadow;
}

template <class S>
typename TracerOf<S>::Shadow TracerOf<S>::CastShadowAmong(std::span<const int32_t> objects,
                                                          const Vec3<S>& point, int light,
                                                          const RayStart& start) const {
  const LightSegment<S> segment = SegmentTo(scene_->lights[static_cast<size_t>(light)], point);
  Shadow shadow;
  shadow.term.state = LightState::kLit;
  ShadowFilters filters;
  const auto add = [&](int object) {
    return AddOccluder(object, point, segment.direction, segment.t_max, start, shadow, filters);
  };
  if (start.side == Side::kInside && !add(start.object)) return shadow;
  for (const int32_t object : objects) {
    if (!add(object)) return shadow;
  }
  shadow.term.crossings = HashOf(filters.list);
  shadow.filter = ProductOf<S>(filters.list, *scene_);
  return shadow;
}

template <class S>
bool TracerOf<S>::ObjectBlocks(int object, const Vec3<S>& point, int light,
                               const RayStart& start) const {
  const LightSegment<S> segment = SegmentTo(scene_->lights[static_cast<size_t>(light)], point);
  return CountBefore(RayCrossings(ShapeOf(object), object, point, segment.direction, start),
                     segment.t_max) > 0;
}

template class TracerOf<double>;
template class TracerOf<long double>;

}  // namespace linetree
