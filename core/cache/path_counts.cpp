// What a path cache holds.
#include "core/cache/path_forest.h"

namespace linetree {

uint64_t PathCache::ByteSize() const {
  const EpochGuard reading;
  uint64_t bytes = 0;
  ForEachForest([&](const Forest& forest) { bytes += forest.store.byte_size(); });
  return bytes;
}

uint64_t PathCache::CountBytes() const {
  const EpochGuard reading;
  uint64_t bytes = 0;
  ForEachForest([&](const Forest& forest) { bytes += forest.store.CountBytes(); });
  return bytes;
}

uint64_t PathCache::CellCount() const {
  const EpochGuard reading;
  uint64_t cells = 0;
  ForEachForest([&](const Forest& forest) { cells += forest.store.cell_count(); });
  return cells;
}

std::vector<std::array<uint64_t, kVerdictCount>> PathCache::CellVerdicts() const {
  const EpochGuard reading;
  std::vector<std::array<uint64_t, kVerdictCount>> verdicts(branches_.size());
  ForEachForest([&](const Forest& forest) {
    forest.store.ForEachTree([&](size_t object, PathTree& tree) {
      const auto counts = tree.cells().counts();
      for (size_t v = 0; v < kVerdictCount; ++v) verdicts[object][v] += counts.cells[v];
    });
  });
  return verdicts;
}

}  // namespace linetree
