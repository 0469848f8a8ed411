// A bounding volume hierarchy over boxes: binned surface area heuristic, flattened in depth-first
// order, at most kMaxLeaf objects per leaf. It knows nothing of shapes: callers bring predicates.
//
// Thread safety: immutable once built. Every traversal returns how much it visited.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/math/box3.h"
#include "core/math/vec3.h"

namespace linetree {

class Bvh {
 public:
  static constexpr int kMaxLeaf = 4;
  // Levels of nodes below which no tree goes; bounds every traversal's stack. The builder splits by
  // cost for the first kMaxCostDepth levels and into halves below, so 2^31 objects fit.
  static constexpr int kMaxCostDepth = 32;
  static constexpr int kMaxDepth = 64;

  // Node 0 is the root. The left child of an inner node is the next node.
  struct Node {
    Box3 box;
    int32_t first = 0;  // leaf: its first entry in objects(); inner node: its right child
    int32_t count = 0;  // leaf: objects in it; inner node: 0
    bool IsLeaf() const { return count > 0; }
  };
  struct Visits {
    size_t nodes = 0;
    size_t objects = 0;
  };

  // Object i is the one with boxes[i]; no box may be empty.
  explicit Bvh(std::span<const Box3> boxes);

  std::span<const Node> nodes() const { return nodes_; }
  // Object indices, leaf by leaf.
  std::span<const int32_t> objects() const { return objects_; }
  size_t ByteSize() const {
    return nodes_.capacity() * sizeof(Node) + objects_.capacity() * sizeof(int32_t);
  }

  // Calls object_fn(int object) -> bool (false ends the traversal) for the objects of all leaves
  // that are reached through boxes for which box_predicate(const Box3&) -> bool holds. Objects' own
  // boxes are not tested.
  template <class BoxPredicate, class ObjectFn>
  Visits ForEachOverlap(BoxPredicate&& box_predicate, ObjectFn&& object_fn) const;

  // Calls object_fn(int object) -> bool (false ends the traversal), roughly front to back, for
  // every object whose box meets origin + t direction, 0 <= t <= t_max, and for some others. t_max
  // is read anew at every node: a search for the nearest hit lowers its variable while this runs.
  template <class S, class ObjectFn>
  Visits ForEachAlong(const Vec3<S>& origin, const Vec3<S>& direction, const S& t_max,
                      ObjectFn&& object_fn) const;

 private:
  std::vector<Node> nodes_;
  std::vector<int32_t> objects_;
  double magnitude_ = 0;  // largest absolute coordinate of the root's box
};

// The slab test of one ray against many boxes. It never says no to a box that contains a hit point
// as the tracer computes it:
//   * A computed hit point lies off its surface, hence perhaps off its box, by rounding of the
//     coordinates involved: a few dozen units of 2^-53 of the largest of them, times the condition
//     of the object's affine map. Boxes are widened by kPad of that coordinate, which leaves room
//     for conditions up to 2^7 or so times those dozens. This also gives flat boxes a thickness.
//   * A distance (b - o) * (1 / d) carries three roundings, a relative error below 4 * 2^-53; its
//     sign is exact. Comparisons of distances are relaxed by kSlack, twice that for both sides.
//   * d = 0 makes the distances infinite with the right signs, or 0 * inf = NaN on a box's plane;
//     the comparisons below are written so that NaN leaves the interval as it is.
template <class S>
class RaySlabs {
 public:
  static constexpr double kPad = 0x1p-40;
  static constexpr double kSlack = 1 + 0x1p-49;

  RaySlabs(const Vec3<S>& origin, const Vec3<S>& direction, double box_magnitude) {
    using std::abs;
    S magnitude = S(box_magnitude);
    for (int i = 0; i < 3; ++i) {
      if (abs(origin[i]) > magnitude) magnitude = abs(origin[i]);
    }
    const S pad = magnitude * S(kPad);
    for (int i = 0; i < 3; ++i) {
      inverse_[i] = S(1) / direction[i];
      backwards_[i] = inverse_[i] < 0;
      near_origin_[i] = backwards_[i] ? origin[i] - pad : origin[i] + pad;
      far_origin_[i] = backwards_[i] ? origin[i] + pad : origin[i] - pad;
    }
  }

  // Whether the ray may meet the box at 0 <= t <= t_max, and from where on.
  bool Meets(const Box3& box, const S& t_max, S& entry) const {
    S near{};
    S far = t_max;
    for (int i = 0; i < 3; ++i) {
      const S a = ((backwards_[i] ? box.max : box.min)[i] - near_origin_[i]) * inverse_[i];
      const S b = ((backwards_[i] ? box.min : box.max)[i] - far_origin_[i]) * inverse_[i];
      near = a > near ? a : near;
      far = b < far ? b : far;
    }
    entry = near;
    return near <= far * S(kSlack);
  }

 private:
  Vec3<S> inverse_, near_origin_, far_origin_;
  bool backwards_[3];
};

template <class BoxPredicate, class ObjectFn>
Bvh::Visits Bvh::ForEachOverlap(BoxPredicate&& box_predicate, ObjectFn&& object_fn) const {
  Visits visits;
  int32_t stack[kMaxDepth];
  int size = 0;
  if (!nodes_.empty()) stack[size++] = 0;
  while (size > 0) {
    const int32_t index = stack[--size];
    const Node& node = nodes_[static_cast<size_t>(index)];
    ++visits.nodes;
    if (!box_predicate(node.box)) continue;
    if (!node.IsLeaf()) {
      stack[size++] = node.first;
      stack[size++] = index + 1;
      continue;
    }
    for (int32_t i = 0; i < node.count; ++i) {
      ++visits.objects;
      if (!object_fn(objects_[static_cast<size_t>(node.first + i)])) return visits;
    }
  }
  return visits;
}

template <class S, class ObjectFn>
Bvh::Visits Bvh::ForEachAlong(const Vec3<S>& origin, const Vec3<S>& direction, const S& t_max,
                              ObjectFn&& object_fn) const {
  struct Pending {
    S entry;
    int32_t node;
  };
  Visits visits;
  Pending stack[kMaxDepth];
  int size = 0;
  const RaySlabs<S> slabs(origin, direction, magnitude_);
  S entry;
  if (nodes_.empty() || !slabs.Meets(nodes_[0].box, t_max, entry)) return visits;
  stack[size++] = {entry, 0};
  while (size > 0) {
    const Pending next = stack[--size];
    if (next.entry > t_max * S(RaySlabs<S>::kSlack)) continue;
    const Node& node = nodes_[static_cast<size_t>(next.node)];
    ++visits.nodes;
    if (node.IsLeaf()) {
      for (int32_t i = 0; i < node.count; ++i) {
        ++visits.objects;
        if (!object_fn(objects_[static_cast<size_t>(node.first + i)])) return visits;
      }
      continue;
    }
    Pending left{{}, next.node + 1};
    Pending right{{}, node.first};
    const bool meets_left =
        slabs.Meets(nodes_[static_cast<size_t>(left.node)].box, t_max, left.entry);
    const bool meets_right =
        slabs.Meets(nodes_[static_cast<size_t>(right.node)].box, t_max, right.entry);
    const bool left_first = meets_left && (!meets_right || left.entry <= right.entry);
    if (meets_left && !left_first) stack[size++] = left;
    if (meets_right) stack[size++] = right;
    if (left_first) stack[size++] = left;
  }
  return visits;
}

}  // namespace linetree
