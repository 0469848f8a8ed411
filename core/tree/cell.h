// Cells of the 4D tree and the integer grid on which their corners lie.
//
// A cell of depth k is an axis-aligned box of edge 2^-k in [0,1]^4. Corners of all cells lie on one
// grid of spacing 2^-kGridBits, so neighbours and generations share corners exactly.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace linetree {

// (a, b, c, d) of a ray in a face pair's chart, each in [0, 1]: a, b where it enters, c, d where it
// leaves (or, for planar objects, its slopes). See ray_space.h.
using RayCoords = std::array<double, 4>;

inline constexpr int kGridBits = 15;
inline constexpr int kMaxCellDepth = kGridBits;
inline constexpr int kCellCorners = 16;
inline constexpr int kCellChildren = 16;

// A corner on the grid: each coordinate in [0, 2^kGridBits].
using GridPoint = std::array<uint16_t, 4>;

inline uint64_t GridKey(const GridPoint& p) {
  return uint64_t{p[0]} | uint64_t{p[1]} << 16 | uint64_t{p[2]} << 32 | uint64_t{p[3]} << 48;
}
inline RayCoords CoordsOfGrid(const GridPoint& p) {
  constexpr double kSpacing = 1.0 / (1 << kGridBits);
  return {p[0] * kSpacing, p[1] * kSpacing, p[2] * kSpacing, p[3] * kSpacing};
}

struct CellId {
  uint8_t depth = 0;
  std::array<uint16_t, 4> index{};  // each in [0, 2^depth)

  bool operator==(const CellId&) const = default;
  auto operator<=>(const CellId&) const = default;

  // Extremal ray i: bit k of i says at which end of axis k.
  GridPoint Corner(int i) const {
    GridPoint p;
    for (std::size_t k = 0; k < 4; ++k) {
      const int steps = index[k] + ((i >> k) & 1);
      p[k] = static_cast<uint16_t>(steps << (kGridBits - depth));
    }
    return p;
  }
  // Child i: bit k of i says which half of axis k.
  CellId Child(int i) const {
    CellId child;
    child.depth = static_cast<uint8_t>(depth + 1);
    for (std::size_t k = 0; k < 4; ++k) {
      child.index[k] = static_cast<uint16_t>(2 * index[k] + ((i >> k) & 1));
    }
    return child;
  }
  // Which child of its ancestor at depth `level` leads here; level < depth.
  int ChildAt(int level) const {
    int child = 0;
    for (std::size_t k = 0; k < 4; ++k) child |= ((index[k] >> (depth - level - 1)) & 1) << k;
    return child;
  }
};

// The cell of the given depth that holds the coordinates; upper faces belong to the last cell.
CellId CellAt(const RayCoords& coords, int depth);

}  // namespace linetree
