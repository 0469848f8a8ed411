// Names for blocks of cells that stay the same when they are built anew, also in another process.
#pragma once

#include <string_view>

#include "core/math/mixed_bits.h"
#include "core/tree/cell.h"
#include "core/tree/surface_chart.h"

namespace linetree {

inline uint64_t CellKey(const SurfaceCell& cell) {
  return MixedBits(uint64_t{cell.i} << 32 | cell.j) + cell.depth;
}
inline uint64_t CellKey(const CellId& cell) { return MixedBits(GridKey(cell.index)) + cell.depth; }

// The children of a cell; `kind` tells stores apart. Two blocks of 2^20 have the same name with
// probability 2^-25; then one of them is not evicted alone.
template <class Cell>
uint64_t BlockId(uint64_t kind, size_t object, int root, const Cell& cell) {
  return MixedBits(MixedBits(MixedBits(kind) + object) + static_cast<uint64_t>(root)) ^
         MixedBits(CellKey(cell));
}
// A tree's roots.
inline uint64_t TreeId(uint64_t kind, size_t object) {
  return MixedBits(~(MixedBits(kind) + object));
}

inline uint64_t HashOfText(std::string_view text) {
  uint64_t hash = text.size();
  for (const char c : text) hash = MixedBits(hash ^ static_cast<unsigned char>(c));
  return hash;
}

}  // namespace linetree
