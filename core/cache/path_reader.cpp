// What the cache knows of a ray, and that it was asked.
#include "core/cache/path_cache.h"

namespace linetree {

template <class Fn>
bool PathCache::Reader::ForEachKnown(const Hit& hit, const Vec3d& direction, PathCoords& at,
                                     Fn&& visit) const {
  const auto object = static_cast<size_t>(hit.object);
  if (store_ == nullptr || !cache_.branches_[object]) return false;
  const PathTree* tree = store_->Get(object);
  if (tree == nullptr) {
    store_->Want(object);
    return false;
  }
  const auto coords = tree->CoordsOf(hit, direction);
  if (!coords) return false;
  at = *coords;
  tree->cells().ForEachAround(at.pair, CellAt(at.coords, cache_.max_depth_),
                              [&](const PathNode& node) {
                                if (node.last_used.load(std::memory_order_relaxed) != now_) {
                                  node.last_used.store(now_, std::memory_order_relaxed);
                                }
                                const CellPaths* paths = node.payload.get();
                                if (paths != nullptr && !paths->steps.empty()) visit(node, *paths);
                              });
  return true;
}

const PathStep* PathCache::Reader::Find(const Hit& hit, const Vec3d& direction) const {
  if (seen_object_ == hit.object && seen_point_ == hit.point && seen_direction_ == direction) {
    if (seen_sample_) Take(*seen_sample_);
    return seen_steps_;
  }
  PathCoords at;
  const PathStep* steps = nullptr;
  const bool placed =
      ForEachKnown(hit, direction, at, [&](const PathNode&, const CellPaths& paths) {
        if (paths.steps[0].EndsAt(hit)) steps = paths.steps.data();
      });
  if (placed) Take({hit.object, at});
  return steps;
}

Verdict PathCache::Reader::Interpolate(const Hit& hit, const Vec3d& direction, double epsilon,
                                       Rgb& radiance) const {
  PathCoords at;
  Verdict verdict = Verdict::kUntried;
  const PathNode* best = nullptr;
  seen_object_ = hit.object;
  seen_point_ = hit.point;
  seen_direction_ = direction;
  seen_steps_ = nullptr;
  seen_sample_.reset();
  const bool placed =
      ForEachKnown(hit, direction, at, [&](const PathNode& node, const CellPaths& paths) {
        const bool ends = paths.steps[0].EndsAt(hit);
        if (ends) seen_steps_ = paths.steps.data();
        verdict = paths.verdict;
        if (verdict != Verdict::kCertified) return;
        verdict = paths.spread <= epsilon ? Verdict::kGap : Verdict::kEpsilon;
        if (paths.spread <= epsilon && ends) best = &node;
      });
  if (placed) seen_sample_ = Sample{hit.object, at};
  if (best == nullptr) return verdict;
  radiance = Evaluate(*best->payload->interpolant, LocalCoords(best->cell, at.coords));
  return Verdict::kCertified;
}

}  // namespace linetree
