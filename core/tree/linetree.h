// A linetree: the lazily built tree of 4D cells of one object and face pair (paper section 6).
//
// Thread safety: Find may run at any time but with Clear, and Publish at the same time as Find and
// itself: who comes first with a cell, by compare-and-swap, publishes it. The other methods that
// change trees, or look at whole ones, run one at a time and not with Publish. What EvictLeaf takes
// out may be freed when nobody reads it any more.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/tree/cell.h"
#include "core/tree/interpolant.h"
#include "core/tree/judge.h"
#include "core/tree/slab_pool.h"

namespace linetree {

// One cell: 16 bytes.
struct CellNode {
  uint32_t children = 0;     // handle of the block of the 16 children, 0: none
  uint32_t interpolant = 0;  // handle, 0: none
  float spread = 0;          // of a certified cell, rounded up
  // Bits 0..3 the verdict, bits 4..31 when it was last used; of an untried cell whether somebody is
  // about to publish it.
  uint32_t state = 0;
};
static_assert(sizeof(CellNode) == 16);

// The children of one cell, and the way back.
struct CellBlock {
  std::array<CellNode, kCellChildren> child;
  uint32_t parent_block = 0;  // 0: the parent is the root
  uint32_t parent_child = 0;
};

// What has been taken out of trees and may still be read.
struct RetiredCells {
  std::vector<uint32_t> blocks, interpolants;  // handles
  std::vector<CellNode*> nodes;                // that had the interpolants

  uint64_t ByteSize() const {
    return blocks.size() * sizeof(CellBlock) + interpolants.size() * sizeof(Interpolant);
  }
};

// Memory that all trees of a cache share.
struct CellPools {
  SlabPool<CellBlock> blocks;
  SlabPool<Interpolant> interpolants;

  uint64_t ByteSize() const {
    return blocks.in_use() * sizeof(CellBlock) + interpolants.in_use() * sizeof(Interpolant);
  }
  // When nobody reads them any more, and before anything else changes.
  void Free(const RetiredCells& retired);
};

// What a walk for one ray found.
struct Lookup {
  enum class Kind : uint8_t {
    kAnswer,   // `interpolant` may answer
    kUnbuilt,  // `cell` has not been tried
    kGiveUp,   // the deepest allowed cell was refused
  };
  Kind kind = Kind::kGiveUp;
  Verdict verdict = Verdict::kUntried;  // of the last cell that was tried on the way
  CellId cell;
  const Interpolant* interpolant = nullptr;  // valid until what was evicted meanwhile is freed
};

// A cell of one tree, as eviction names it.
struct CellHandle {
  uint32_t block = 0;  // 0: the root
  uint32_t child = 0;
};

class Linetree {
 public:
  // `pools` must outlive the tree; Clear before destruction gives its cells back.
  explicit Linetree(CellPools& pools) : pools_(&pools) {}

  // Walks towards the coordinates until a cell answers at epsilon, is unbuilt, or lies at
  // max_depth. Marks the last tried cell as used at `now`.
  Lookup Find(const RayCoords& coords, double epsilon, int max_depth, uint32_t now) const;

  // Stores the judgement of a cell; true if nobody else has. Where eviction has taken the cell's
  // parents meanwhile it is dropped.
  bool Publish(const CellId& cell, const Judgement& judgement, uint32_t now);

  // Visits the cells that have been tried and have no tried children.
  void ForEachLeaf(const std::function<void(CellHandle, uint32_t last_used)>& visit) const;

  // Forgets a leaf, and its block of siblings when it was the last tried one among them.
  void EvictLeaf(CellHandle leaf, RetiredCells& retired);

  void Clear();

  uint64_t cell_count() const { return cell_count_; }
  // Tried cells by their verdict.
  std::array<uint64_t, kVerdictCount> verdicts() const;
  // Recomputes what this tree holds of the pools, from scratch.
  uint64_t CountBytes() const;

 private:
  CellNode& At(CellHandle h) const {
    return h.block == 0 ? root_ : pools_->blocks[h.block].child[h.child];
  }
  // Handle of the children, which are made where there are none.
  uint32_t ChildrenOf(CellHandle parent);
  bool HasTriedChild(const CellNode& node) const;
  // Visits every block, children before parents.
  void ForEachBlock(const std::function<void(uint32_t block)>& visit) const;

  CellPools* pools_;
  mutable CellNode root_;  // mutable like the pools' cells: Find marks it as used
  std::atomic<uint64_t> cell_count_{0};
  std::array<std::atomic<uint64_t>, kVerdictCount> verdicts_{};
};

// Stamps wrap after 2^28 ticks of the clock; then a cell may be taken for fresh once, which costs
// time and never accuracy.
inline constexpr uint32_t kStampMask = 0x0fffffff;

}  // namespace linetree
