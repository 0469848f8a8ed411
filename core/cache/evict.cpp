// Eviction: leaf first, least recently used first.
#include <algorithm>
#include <tuple>

#include "core/cache/forest.h"
#include "core/cache/radiance_cache.h"

namespace linetree {
namespace {

// Ordered by use; ties are broken the same way every time, whatever order the tables iterate in.
struct Victim {
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

// One pass frees an eighth of the budget, so that the cost of looking at all leaves is spread over
// many new cells.
constexpr uint64_t kSlackDivisor = 8;

}  // namespace

uint64_t RadianceCache::MakeRoom(uint64_t needed, uint32_t now) {
  const uint64_t slack = cell_budget_ / kSlackDivisor;
  const uint64_t keep = std::max(needed, slack);
  const uint64_t target = cell_budget_ > keep ? cell_budget_ - keep : 0;
  uint64_t evicted = 0;
  // Evicting leaves makes leaves of their parents; go on until it suffices or nothing is left.
  for (bool progress = true; progress && CellBytes() > target;) {
    std::vector<Victim> victims;
    for (const auto& forest : forests_) {
      for (auto& [object, trees] : forest->objects) {
        for (int32_t pair = 0; pair < kFacePairs; ++pair) {
          Linetree& tree = trees->pair[static_cast<size_t>(pair)];
          tree.ForEachLeaf([&, object = object](CellHandle cell, uint32_t last_used) {
            if (last_used == now) return;  // in use by the batch that needs the room
            victims.push_back({last_used, forest->id, object, pair, cell, &tree});
          });
        }
      }
    }
    progress = !victims.empty();
    std::sort(victims.begin(), victims.end());
    for (const Victim& victim : victims) {
      if (CellBytes() <= target) break;
      victim.tree->EvictLeaf(victim.cell);
      ++evicted;
    }
    for (const auto& forest : forests_) {
      absl::erase_if(forest->objects, [](const auto& entry) {
        const auto& pairs = entry.second->pair;
        return std::all_of(pairs.begin(), pairs.end(),
                           [](const Linetree& tree) { return tree.cell_count() == 0; });
      });
    }
  }
  return evicted;
}

}  // namespace linetree
