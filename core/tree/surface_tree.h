// The surface tree of one object: for every patch a quadtree over its chart, whose cells say what
// is certain about the lights (DESIGN: two kinds of tree). Thread safety as in cell_tree.h.
#pragma once

#include <optional>
#include <vector>

#include "core/trace/light_lists.h"
#include "core/tree/cell_tree.h"
#include "core/tree/light_certifier.h"
#include "core/tree/surface_chart.h"

namespace linetree {

struct SurfaceTraits {
  using Cell = SurfaceCell;
  using Payload = CellLights;
  static constexpr size_t kChildren = 4;
  static constexpr int kMaxDepth = kMaxSurfaceDepth;
  static constexpr size_t kKinds = 1;
  static size_t KindOf(const Payload&) { return 0; }
};
using SurfaceNode = CellTreeNode<SurfaceTraits>;

class SurfaceTree {
 public:
  using Traits = SurfaceTraits;
  using Node = SurfaceNode;
  using Cell = SurfaceCell;

  // Keeps a reference to the object.
  explicit SurfaceTree(const Object& object);

  const Object& object() const { return object_; }
  const SurfaceChart& chart() const { return chart_; }
  CellTree<SurfaceTraits>& cells() { return cells_; }
  const CellTree<SurfaceTraits>& cells() const { return cells_; }
  const SurfaceChart::FaceForm& FormOf(int face) const { return forms_[static_cast<size_t>(face)]; }

  // What the smallest cell knows that holds the hit, with sums that meet `epsilon`. Counts a use,
  // which stands for `points` of them.
  KnownLights Find(const Hit& hit, double epsilon, uint32_t now, uint32_t points = 1) const;

  uint64_t CountBytes() const;
  uint64_t OwnBytes() const;  // without what cells know and their children

 private:
  // (s, t): the hit's coordinates in the cell.
  void AddDiffuse(const Hit& hit, double s, double t, const CellLights& lights, double epsilon,
                  KnownLights& known) const;

  // Which of the sums holds at a hit; nothing for inner sides, and where a grazing ray's normal has
  // been turned inwards by rounding.
  std::optional<size_t> SideOf(const Hit& hit) const;

  const Object& object_;
  SurfaceChart chart_;
  std::vector<SurfaceChart::FaceForm> forms_;  // by face
  CellTree<SurfaceTraits> cells_;
};

}  // namespace linetree
