// Eviction: leaf first, least recently used first.
#include <algorithm>
#include <tuple>

#include "core/cache/epoch.h"
#include "core/cache/forest.h"
#include "core/cache/radiance_cache.h"

namespace linetree {
namespace {

// One pass frees an eighth of the budget, so that the cost of looking at all leaves is spread over
// many new cells.
constexpr uint64_t kSlackDivisor = 8;

}  // namespace

// Ordered by use; ties are broken the same way every time.
struct RadianceCache::Victim {
  uint32_t last_used;
  uint32_t forest;
  int32_t object;
  int32_t pair;
  CellHandle cell;
  Linetree* tree;

  bool operator<(const Victim& o) const {
    return std::tie(last_used, forest, object, pair, cell.block, cell.child) <
           std::tie(o.last_used, o.forest, o.object, o.pair, o.cell.block, o.cell.child);
  }
};

std::vector<RadianceCache::Victim> RadianceCache::Leaves(uint32_t now) const {
  std::vector<Victim> leaves;
  ForEachForest([&](const Forest& forest) {
    forest.ForEach([&](int32_t object, ObjectTrees& trees) {
      for (int32_t pair = 0; pair < kFacePairs; ++pair) {
        Linetree& tree = trees.pair[static_cast<size_t>(pair)];
        tree.ForEachLeaf([&](CellHandle cell, uint32_t last_used) {
          if (last_used == now) return;  // in use by the batch that needs the room
          leaves.push_back({last_used, forest.id, object, pair, cell, &tree});
        });
      }
    });
  });
  std::sort(leaves.begin(), leaves.end());
  return leaves;
}

uint64_t RadianceCache::MakeRoom(uint64_t needed, uint32_t now) {
  const uint64_t slack = cell_budget_ / kSlackDivisor;
  const uint64_t keep = std::max(needed, slack);
  const uint64_t target = cell_budget_ > keep ? cell_budget_ - keep : 0;
  RetiredCells retired;
  std::vector<std::unique_ptr<ObjectTrees>> bare;
  uint64_t evicted = 0, left = CellBytes();
  const uint64_t before = left;
  // Evicting leaves makes leaves of their parents; go on until it suffices or nothing is left.
  for (bool progress = true; progress && left > target;) {
    const std::vector<Victim> victims = Leaves(now);
    progress = !victims.empty();
    for (const Victim& victim : victims) {
      if (left <= target) break;
      victim.tree->EvictLeaf(victim.cell, retired);
      left = before - retired.ByteSize() - bare.size() * sizeof(ObjectTrees);
      ++evicted;
    }
    TakeBareTrees(bare);
    left = before - retired.ByteSize() - bare.size() * sizeof(ObjectTrees);
  }
  if (evicted == 0) return 0;
  AwaitReaders();
  pools_.Free(retired);
  return evicted;
}

void RadianceCache::TakeBareTrees(std::vector<std::unique_ptr<ObjectTrees>>& bare) {
  ForEachForest([&](Forest& forest) {
    forest.ForEach([&](int32_t object, const ObjectTrees& trees) {
      const bool is_bare = std::all_of(trees.pair.begin(), trees.pair.end(),
                                       [](const Linetree& tree) { return tree.cell_count() == 0; });
      if (!is_bare) return;
      bare.push_back((*forest.trees)[static_cast<size_t>(object)].Take());
      --forest.grown;
    });
  });
}

}  // namespace linetree
