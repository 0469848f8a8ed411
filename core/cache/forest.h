// The linetrees of all objects for one PathLimits. Private to the cache.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <vector>

#include "core/cache/radiance_cache.h"
#include "core/tree/owning_slot.h"

namespace linetree {

// The six linetrees of one object, made when its first cell is built.
struct RadianceCache::ObjectTrees {
  explicit ObjectTrees(CellPools& pools)
      : pair{Linetree(pools), Linetree(pools), Linetree(pools),
             Linetree(pools), Linetree(pools), Linetree(pools)} {}
  std::array<Linetree, kFacePairs> pair;
};

struct RadianceCache::Forest {
  using Trees = std::vector<OwningSlot<ObjectTrees>>;

  uint32_t id = 0;
  std::atomic<uint32_t> last_used{0};
  PathLimits limits;
  size_t objects = 0;              // of the scene
  OwningSlot<Trees> trees;         // by object; made with the first of them
  std::atomic<uint64_t> grown{0};  // objects that have trees

  uint64_t ByteSize() const { return grown * sizeof(ObjectTrees) + (trees ? TableBytes() : 0); }
  // The most that one more object can add.
  uint64_t GrowthBytes() const { return sizeof(ObjectTrees) + (trees ? 0 : TableBytes()); }
  // Within a guard, or by those who change them.
  ObjectTrees* Find(int32_t object) const {
    const Trees* all = trees.get();
    return all == nullptr ? nullptr : (*all)[static_cast<size_t>(object)].get();
  }
  // visit(int32_t object, ObjectTrees&); as Find.
  template <class Fn>
  void ForEach(Fn&& visit) const {
    const Trees* all = trees.get();
    for (size_t object = 0; all != nullptr && object < all->size(); ++object) {
      if (ObjectTrees* of = (*all)[object].get()) visit(static_cast<int32_t>(object), *of);
    }
  }

 private:
  uint64_t TableBytes() const { return sizeof(Trees) + objects * sizeof((*trees)[0]); }
};

}  // namespace linetree
