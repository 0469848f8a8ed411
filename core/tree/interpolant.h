// What a cell stores to answer rays: the radiances of its 16 extremal rays.
#pragma once

#include <array>

#include "core/math/rgb.h"
#include "core/tree/cell.h"

namespace linetree {

// 192 bytes. Radiance is kept in float: a rounding of 2^-24 relative, which kStorageRounding covers
// and the epsilon test adds to the spread of the corners.
struct Interpolant {
  std::array<std::array<float, 3>, kCellCorners> corner;
};
inline constexpr double kStorageRounding = 0x1p-23;

// Quadrilinear interpolation. `local` are coordinates within the cell, each in [0, 1]; bit k of a
// corner's number says at which end of axis k it lies. The result lies between the smallest and the
// largest corner (up to kStorageRounding) and equals them where all are equal.
Rgb Evaluate(const Interpolant& interpolant, const RayCoords& local);

// Coordinates within the cell.
RayCoords LocalCoords(const CellId& cell, const RayCoords& coords);

}  // namespace linetree
