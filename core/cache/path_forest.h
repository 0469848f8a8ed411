// The trees for one PathLimits. Private to the cache.
#pragma once

#include <bit>

#include "core/cache/path_cache.h"

namespace linetree {

struct PathCache::Forest {
  Forest(const Scene& scene, const PathLimits& path_limits, uint64_t memory_bytes,
         const BuildCosts& costs, EvictedCounter& evicted)
      : limits(path_limits),
        store(scene, memory_bytes, evicted),
        ledger(LedgerKind(limits), costs) {}

  // Tells blocks from those of other forests and caches.
  static uint64_t LedgerKind(const PathLimits& limits) {
    return MixedBits(std::bit_cast<uint64_t>(limits.min_weight)) +
           static_cast<uint64_t>(limits.max_depth);
  }

  uint64_t BytesHeld() const { return store.byte_size() + ledger_bytes; }

  const PathLimits limits;
  TreeStore<PathTree> store;
  BlockLedger<PathTree> ledger;
  std::atomic<uint64_t> ledger_bytes{0};  // for those who may not ask the ledger
  std::atomic<uint32_t> last_used{0};
  int builders = 0;  // guarded by ledger_mutex_
};

}  // namespace linetree
