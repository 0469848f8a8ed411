// What a scene keeps in memory beside itself.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace linetree {

// Bytes that are allocated now: what the parts hold, counted as it is taken and given back, without
// what the allocator adds.
struct MemoryPart {
  std::string_view name;
  uint64_t bytes = 0;
  uint64_t cells = 0;  // of trees: those of which something is known; else 0
  bool has_cells = false;

  // With nodes, lists and samples; 0 without cells.
  double BytesPerCell() const {
    return cells == 0 ? 0 : static_cast<double>(bytes) / static_cast<double>(cells);
  }
};

// Of all of them together.
inline uint64_t BytesOf(const std::vector<MemoryPart>& parts) {
  uint64_t bytes = 0;
  for (const MemoryPart& part : parts) bytes += part.bytes;
  return bytes;
}

inline uint64_t CellsOf(const std::vector<MemoryPart>& parts) {
  uint64_t cells = 0;
  for (const MemoryPart& part : parts) cells += part.cells;
  return cells;
}

}  // namespace linetree
