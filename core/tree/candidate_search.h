// Which objects may meet a bundle of rays: the search behind every candidate list.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/trace/tracer.h"
#include "core/tree/shaft.h"

namespace linetree {

// A list that is longer is not kept: the scene's hierarchy finds what a ray meets faster.
inline constexpr size_t kMaxCandidates = 24;

// Rays must clear objects by this share of the lengths involved before an object is dropped:
// a million times the rounding of a crossing (about 2^-50), a thousandth of a pixel at the finest.
inline constexpr double kClearance = 0x1p-30;

// kClearance for rays inside a box: its size and its distance from the world's origin count.
double ClearanceOf(const Box3& box);

// How far the surface of an object that rays meet may lie outside the one whose support (support.h)
// is taken. World length.
double SurplusOf(const Object& object);

class CandidateSearch {
 public:
  // Keeps a reference to the tracer, which must outlive it.
  explicit CandidateSearch(const Tracer& tracer);

  // SurplusOf the object.
  double Surplus(int object) const { return surplus_[static_cast<size_t>(object)]; }

  // may_meet(int object) -> bool. Both give what it keeps, ascending; one object more than
  // kMaxCandidates at most, which says that the list is too long.
  template <class Fn>
  std::vector<int32_t> Among(std::span<const int32_t> objects, Fn&& may_meet) const {
    std::vector<int32_t> kept;
    for (const int32_t object : objects) {
      if (kept.size() > kMaxCandidates) break;
      if (may_meet(object)) kept.push_back(object);
    }
    return kept;
  }
  // Of all objects whose bounds come within `clearance` of the hull of two boxes.
  template <class Fn>
  std::vector<int32_t> InShaft(const Box3& from, const Box3& to, double clearance,
                               Fn&& may_meet) const {
    std::vector<int32_t> kept;
    const auto consider = [&](int object) {
      if (may_meet(object)) kept.push_back(object);
      return kept.size() <= kMaxCandidates;
    };
    const Shaft shaft(Widened(from, clearance), Widened(to, clearance));
    if (tracer_.bvh() != nullptr) {
      tracer_.bvh()->ForEachOverlap([&](const Box3& box) { return !shaft.Misses(box); }, consider);
      std::sort(kept.begin(), kept.end());
      return kept;
    }
    const int count = static_cast<int>(tracer_.scene().objects.size());
    for (int object = 0; object < count; ++object) {
      if (shaft.Misses(tracer_.scene().objects[static_cast<size_t>(object)].bounds)) continue;
      if (!consider(object)) break;
    }
    return kept;
  }

 private:
  static Box3 Widened(Box3 box, double clearance);

  const Tracer& tracer_;
  std::vector<double> surplus_;  // by object
};

}  // namespace linetree
