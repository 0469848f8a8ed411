// What a cache may hold and when it builds: one plain struct, validated by whoever reads the flags.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "core/tree/cell.h"

namespace linetree {

inline constexpr char kDefaultPolicy[] = "reuse";

struct CacheOptions {
  // For cells, interpolants and corner samples together. 0 turns the cache off.
  uint64_t memory_bytes = uint64_t{256} << 20;
  // Deepest cells, in [0, kMaxCellDepth]: edge 2^-max_cell_depth of an object's face.
  int max_cell_depth = 10;
  // A cell is built only for at least this many rays of one batch. A cell costs up to sixteen
  // corner samples, of which neighbours share most.
  uint32_t min_cell_rays = 8;
  // Frames by packets ask the surface trees everywhere and let them grow, also where that does not
  // pay: for tests and audits of what the trees say.
  bool always_ask = false;
  // By which surface trees and certified linetrees evict: one of AllPolicies (core/policy), or
  // empty for the plain order of their stores, least recently used first.
  std::string policy = kDefaultPolicy;
};

// Cells that were certified for requests that nobody had made yet (RenderOptions::ahead), and those
// of them that others have used since. The rest is still to be used, or was wasted.
struct AheadCounts {
  uint64_t built = 0;
  uint64_t used = 0;
};
// The same while many threads count.
struct AheadCounters {
  std::atomic<uint64_t> built{0}, used{0};
  AheadCounts now() const { return {built, used}; }
};

// Shares of the memory that the surface trees and the certified linetrees get; the linetrees of the
// paper's judge and their samples get the rest.
inline constexpr double kSurfaceShare = 0.25;
inline constexpr double kPathShare = 0.25;

// Corner samples only make building cheaper, so they get at most this share of the linetrees'
// memory.
inline constexpr double kSampleShare = 0.25;

}  // namespace linetree
