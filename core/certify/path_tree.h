// The certified linetree of one object: for every face pair a tree of 4D cells that say where the
// rays that leave the object go (DESIGN: two kinds of tree). Thread safety as in cell_tree.h.
#pragma once

#include <optional>

#include "core/certify/cell_paths.h"
#include "core/tree/cell_tree.h"
#include "core/tree/ray_space.h"

namespace linetree {

struct PathTraits {
  using Cell = CellId;
  using Payload = CellPaths;
  static constexpr size_t kChildren = kCellChildren;
  static constexpr int kMaxDepth = kMaxCellDepth;
  static constexpr size_t kKinds = kVerdictCount;
  static size_t KindOf(const Payload& paths) { return static_cast<size_t>(paths.verdict); }
};
using PathNode = CellTreeNode<PathTraits>;

// Where a ray lies in the ray space of an object.
struct PathCoords {
  int pair = 0;
  RayCoords coords{};
};

class PathTree {
 public:
  using Traits = PathTraits;
  using Node = PathNode;
  using Cell = CellId;

  explicit PathTree(const Object& object)
      : max_hit_distance_(MaxHitDistance(object)), chart_(object), cells_(kFacePairs) {}

  const ObjectChart& chart() const { return chart_; }
  CellTree<PathTraits>& cells() { return cells_; }
  const CellTree<PathTraits>& cells() const { return cells_; }

  // The coordinates of a ray that hits the object from outside, at its first crossing with the
  // ray's line; nothing for other hits, for rays from so far away that their hits are not accurate
  // enough, and where the line has no coordinates.
  std::optional<PathCoords> CoordsOf(const Hit& hit, const Vec3d& direction) const {
    if (!hit.first_on_line || hit.side != Side::kOutside) return std::nullopt;
    if (!(hit.t <= max_hit_distance_)) return std::nullopt;
    const int pair = chart_.PairOf(direction);
    // Measured from the hit: far eyes would otherwise cost the coordinates their last digits.
    const auto coords = chart_.CoordsOf(pair, hit.point, direction);
    if (!coords) return std::nullopt;
    return PathCoords{pair, *coords};
  }

  uint64_t CountBytes() const { return OwnBytes() + cells_.Recount().bytes; }
  uint64_t OwnBytes() const {  // without what cells know and their children
    return sizeof(PathTree) - sizeof(cells_) + cells_.OwnBytes();
  }

 private:
  double max_hit_distance_;
  ObjectChart chart_;
  CellTree<PathTraits> cells_;
};

}  // namespace linetree
