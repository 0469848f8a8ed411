// The linetrees of all objects for one PathLimits. Private to the cache.
#pragma once

#include <array>
#include <memory>

#include "absl/container/flat_hash_map.h"
#include "core/cache/radiance_cache.h"

namespace linetree {

// The six linetrees of one object, made when its first cell is built.
struct RadianceCache::ObjectTrees {
  explicit ObjectTrees(CellPools& pools)
      : pair{Linetree(pools), Linetree(pools), Linetree(pools),
             Linetree(pools), Linetree(pools), Linetree(pools)} {}
  std::array<Linetree, kFacePairs> pair;
};

struct RadianceCache::Forest {
  uint32_t id = 0;
  uint32_t last_used = 0;
  PathLimits limits;
  absl::flat_hash_map<int32_t, std::unique_ptr<ObjectTrees>> objects;

  // A slot of the table (key, pointer, padding) and its control byte.
  static constexpr uint64_t kSlotBytes =
      sizeof(std::pair<const int32_t, std::unique_ptr<ObjectTrees>>) + 1;

  uint64_t ByteSize() const {
    return objects.size() * sizeof(ObjectTrees) + objects.capacity() * kSlotBytes;
  }
  // The most that one more object can add; the table doubles when it is full.
  uint64_t GrowthBytes() const {
    return sizeof(ObjectTrees) + (objects.capacity() + 8) * kSlotBytes;
  }
  Linetree* Find(int32_t object, int32_t pair) const {
    const auto it = objects.find(object);
    return it == objects.end() ? nullptr : &it->second->pair[static_cast<size_t>(pair)];
  }
};

}  // namespace linetree
