// Cells that packets have met of late, so that the next packet in the same cell does not walk down
// its tree again.
#if defined(LINETREE_CORE_FRAME_OPEN_CELLS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_FRAME_OPEN_CELLS_INL_H_
#undef LINETREE_CORE_FRAME_OPEN_CELLS_INL_H_
#else
#define LINETREE_CORE_FRAME_OPEN_CELLS_INL_H_
#endif

#include <bit>

#include "core/cache/surface_cache.h"
#include "core/frame/places-inl.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

// Trees do not change while the reader lives.
class OpenCells {
 public:
  struct Entry {
    const SurfaceTree* tree = nullptr;
    const SurfaceNode* node = nullptr;
    int32_t patch = 0, i = 0, j = 0;  // the cell, at its depth
    int shift = 0;                    // from the deepest cells' indices
    uint32_t uses = 0;                // not counted by the node yet
  };

  HWY_INLINE explicit OpenCells(const SurfaceCache::Reader& reader) : reader_(reader) {}
  HWY_INLINE ~OpenCells() {
    for (Entry& entry : entries_) Close(entry);
  }
  OpenCells(const OpenCells&) = delete;
  OpenCells& operator=(const OpenCells&) = delete;

  // Whether those who ask for cells are counted from now on.
  HWY_INLINE void CountUses(bool counts) { counts_ = counts; }
  HWY_INLINE void AddUses(Entry& entry, LaneMask lanes) const {
    if (counts_) entry.uses += static_cast<uint32_t>(std::popcount(lanes));
  }

  // The smallest cell that holds the place of this lane. Valid until the next call.
  HWY_INLINE Entry& Find(const SurfaceTree& tree, const Places& places, int lane) {
    return Find(tree, places.patch[lane], places.i[lane], places.j[lane]);
  }
  // i, j: of a cell of depth kMaxSurfaceDepth.
  HWY_INLINE Entry& Find(const SurfaceTree& tree, int32_t patch, int32_t i, int32_t j) {
    for (int back = 0; back < kEntries; ++back) {
      Entry& entry = entries_[(newest_ - back) & (kEntries - 1)];
      if (entry.tree == &tree && entry.patch == patch && i >> entry.shift == entry.i &&
          j >> entry.shift == entry.j) {
        return entry;
      }
    }
    newest_ = (newest_ + 1) & (kEntries - 1);
    Entry& entry = entries_[newest_];
    Close(entry);
    const SurfaceCell deepest = {kMaxSurfaceDepth, static_cast<uint32_t>(i),
                                 static_cast<uint32_t>(j)};
    const SurfaceNode& node = tree.cells().Find(patch, deepest, reader_.now());
    entry = {&tree,
             &node,
             patch,
             static_cast<int32_t>(node.cell.i),
             static_cast<int32_t>(node.cell.j),
             kMaxSurfaceDepth - node.cell.depth,
             0};
    return entry;
  }

 private:
  static constexpr int kEntries = 16;

  static HWY_INLINE void Close(Entry& entry) {
    if (entry.uses > 0) entry.node->uses.fetch_add(entry.uses, std::memory_order_relaxed);
    entry.uses = 0;
  }

  const SurfaceCache::Reader& reader_;
  Entry entries_[kEntries];
  int newest_ = 0;
  bool counts_ = true;
};

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
