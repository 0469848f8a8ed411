// The trees for one PathLimits. Private to the cache.
#pragma once

#include <bit>

#include "core/cache/path_cache.h"

namespace linetree {

struct PathCache::Forest {
  Forest(const Scene& scene, const PathLimits& path_limits, uint64_t memory_bytes,
         const BuildCosts& costs)
      : limits(path_limits), store(scene, memory_bytes), ledger(LedgerKind(limits), costs) {}

  // Tells blocks from those of other forests and caches.
  static uint64_t LedgerKind(const PathLimits& limits) {
    return MixedBits(std::bit_cast<uint64_t>(limits.min_weight)) +
           static_cast<uint64_t>(limits.max_depth);
  }

  PathLimits limits;
  TreeStore<PathTree> store;
  BlockLedger<PathTree> ledger;
  uint32_t last_used = 0;
};

}  // namespace linetree
