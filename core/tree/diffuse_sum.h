// The diffuse light that many lights together throw on a piece of surface, as a polynomial in the
// coordinates of its cell.
#pragma once

#include <array>
#include <cstdint>

#include "core/math/rgb.h"

namespace linetree {

// sum_l E_l max(0, n.l) over the lights of a cell that are marked as summed. Its error is relative
// to the sum itself, channel by channel: what is composed of such sums with coefficients that are
// not negative has the same relative error, so errors of nested surfaces need no budget.
struct DiffuseSum {
  // Nodes an axis: 4 at 0, 1/3, 2/3, 1 (bicubic) or 2 at 0, 1 (bilinear).
  int nodes = 4;
  double spread = 0;  // |At - exact| <= spread * exact, proved
  // Node (i, j) at number j * nodes + i.
  std::array<std::array<float, 3>, 16> value{};

  // u, v in [0, 1] over the cell.
  Rgb At(double u, double v) const;
};

}  // namespace linetree
