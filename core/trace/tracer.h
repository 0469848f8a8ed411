// The classical (Whitted) tracer: the reference of every error figure (DESIGN: scene and shading).
//
// Templated on its scalar S. Tracer = TracerOf<double> is the reference; the same code in a wider
// type measures the reference's own rounding. Thread safety: all methods are const and may be
// called from any number of threads.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/scene/scene.h"
#include "core/trace/bvh.h"
#include "core/trace/counts.h"
#include "core/trace/hit.h"
#include "core/trace/light_lists.h"
#include "core/trace/media.h"
#include "core/trace/path_lists.h"
#include "core/trace/ray_tree.h"

namespace linetree {

// Where paths end. What lies beyond is black.
struct PathLimits {
  int max_depth = 4;         // rays on a path, the eye ray counted; in [1, kMaxPathDepth]
  double min_weight = 0.01;  // a branch of smaller weight is not cast; in [0, 1]
  bool operator==(const PathLimits&) const = default;

  // Whether a branch with coefficient k is cast from the end of a ray of the given depth (the eye
  // ray's is 1) and weight.
  bool Allow(int depth, double weight, const Rgb& k) const {
    return !IsBlack(k) && depth < max_depth && weight * MaxChannel(k) >= min_weight;
  }
};
inline constexpr int kMaxPathDepth = 16;

enum class Hierarchy { kAuto, kFlat, kBvh };
// kAuto uses the BVH above this many objects.
inline constexpr size_t kFlatLimit = 32;

// The answer for one ray.
struct Traced {
  Rgb radiance;
  Hit hit;  // of the ray itself
};

struct ShadowFilters;  // the transparent objects met by one shadow ray

template <class S>
class TracerOf {
 public:
  // Keeps a reference to the scene, which must outlive the tracer.
  explicit TracerOf(const Scene& scene, Hierarchy hierarchy = Hierarchy::kAuto);

  const Scene& scene() const { return *scene_; }

  const Media& media() const { return media_; }

  // The nearest hit with t > 0 (t = 0 only for a grazing exit from the solid that the ray starts
  // inside). Of objects met at the same t the one with the smallest index. `direction` may have any
  // length. Counts nothing; see counts.intersect.
  HitOf<S> Intersect(const Vec3<S>& origin, const Vec3<S>& direction, const RayStart& start) const;

  // The same where the ray can meet nothing but the given objects: equal bits, without a search.
  HitOf<S> IntersectAmong(std::span<const int32_t> objects, const Vec3<S>& origin,
                          const Vec3<S>& direction, const RayStart& start) const;

  // The first crossing of one object by the whole line (t unbounded below), as linetrees see it:
  // the hit of a ray that comes from infinity. Not a hit when the line misses the object.
  HitOf<S> IntersectObjectLine(int object, const Vec3<S>& origin, const Vec3<S>& direction) const;

  // Light arriving at `point` from light `light` along the segment: LightState kLit or kBlocked and
  // the filter V_l (black when blocked). `start` is the surface that the shadow ray leaves. Which
  // of several occluders the term names is not specified.
  struct Shadow {
    LightTerm term;
    RgbOf<S> filter;
  };
  Shadow CastShadow(const Vec3<S>& point, int light, const RayStart& start) const;
  // The same where only the given objects may be in between and, for a start on an inner side, the
  // start's own object: equal bits, without a search.
  Shadow CastShadowAmong(std::span<const int32_t> objects, const Vec3<S>& point, int light,
                         const RayStart& start) const;

  // Whether one object alone blocks the way from `point` to the light (any of its surfaces; whether
  // it is opaque is not asked).
  bool ObjectBlocks(int object, const Vec3<S>& point, int light, const RayStart& start) const;

  // Radiance along an eye ray, whose direction is unit. With `tree`, also its ray tree (in double;
  // the vectors' capacity is reused). Adds to counts.
  RgbOf<S> Radiance(const Vec3<S>& origin, const Vec3<S>& direction, const PathLimits& limits,
                    RayCounts& counts, RayTree* tree = nullptr) const;

  // Radiance of an eye ray whose first hit is known. Counts no eye ray and no Intersect for it.
  RgbOf<S> RadianceFromHit(const HitOf<S>& hit, const Vec3<S>& origin, const Vec3<S>& direction,
                           const PathLimits& limits, RayCounts& counts,
                           RayTree* tree = nullptr) const;

  // The same bits, with `lights` asked before the scene is searched for occluders and `paths`,
  // which may be null, before it is searched for what a branch meets. Double only.
  RgbOf<S> RadianceFromHit(const HitOf<S>& hit, const Vec3<S>& origin, const Vec3<S>& direction,
                           const PathLimits& limits, const LightLists& lights,
                           const PathLists* paths, RayCounts& counts) const;

  // The objects' hierarchy; null when the tracer is flat.
  const Bvh* bvh() const { return bvh_.get(); }

 private:
  // Takes the crossings of one object into account; `nearest` is the smallest t so far.
  void Approach(int object, const Vec3<S>& origin, const Vec3<S>& direction, const RayStart& start,
                S& nearest, HitOf<S>& hit) const;
  // Fills in what follows from the object, the face and t.
  void Complete(const Vec3<S>& origin, const Vec3<S>& direction, const S& t, HitOf<S>& hit) const;

  // fn(int object) -> bool (false ends the search) for all objects that the ray may meet up to
  // t_max.
  template <class ObjectFn>
  void ForEachAlong(const Vec3<S>& origin, const Vec3<S>& direction, const S& t_max,
                    ObjectFn&& fn) const;

  // Takes one object that may be in between into account; false when it ends the search.
  bool AddOccluder(int object, const Vec3<S>& point, const Vec3<S>& direction, const S& t_max,
                   const RayStart& start, Shadow& shadow, ShadowFilters& filters) const;

  const Shape& ShapeOf(int object) const {
    return scene_->objects[static_cast<size_t>(object)].shape;
  }

  const Scene* scene_;
  Media media_;
  std::unique_ptr<const Bvh> bvh_;
};

using Tracer = TracerOf<double>;

}  // namespace linetree
