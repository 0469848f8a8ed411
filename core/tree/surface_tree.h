// The surface tree of one object: for every patch a quadtree over its chart, whose cells say what
// is certain about the lights (DESIGN: two kinds of tree).
//
// Thread safety: Find may run at the same time as itself (it counts uses with relaxed atomics);
// what changes the tree needs exclusive access.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/trace/light_lists.h"
#include "core/tree/light_certifier.h"
#include "core/tree/surface_chart.h"

namespace linetree {

struct SurfaceNode {
  SurfaceCell cell;
  int patch = 0;
  bool certified = false;  // `lights` is filled
  CellLights lights;
  std::unique_ptr<std::array<SurfaceNode, 4>> children;
  // Shading points found in this cell and no smaller one, since they were last taken.
  mutable std::atomic<uint32_t> uses{0};
  mutable std::atomic<uint32_t> last_used{0};  // clock of the cache

  bool IsLeaf() const { return children == nullptr; }
  uint64_t ByteSize() const {  // without the node itself, which its parent holds
    return lights.HeapBytes() + (children ? sizeof(*children) : 0);
  }
};

class SurfaceTree {
 public:
  explicit SurfaceTree(const Object& object);

  const SurfaceChart& chart() const { return chart_; }

  // What the smallest cell knows that holds the hit, or null. Counts a use.
  const LightList* Find(const Hit& hit, uint32_t now) const;

  // Visits all nodes, parents before children.
  void ForEach(const std::function<void(SurfaceNode&)>& visit);

  uint64_t CountBytes() const;

 private:
  SurfaceChart chart_;
  std::vector<SurfaceNode> roots_;  // one for each patch; never resized
};

}  // namespace linetree
