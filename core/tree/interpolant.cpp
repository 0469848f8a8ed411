#include "core/tree/interpolant.h"

#include <algorithm>

namespace linetree {

Rgb Evaluate(const Interpolant& interpolant, const RayCoords& local) {
  Rgb out;
  for (int channel = 0; channel < 3; ++channel) {
    std::array<double, kCellCorners> v;
    for (size_t m = 0; m < kCellCorners; ++m) {
      v[m] = static_cast<double>(interpolant.corner[m][static_cast<size_t>(channel)]);
    }
    // Collapse the highest axis first: corners m and m + width differ in it alone. The form
    // a + t (b - a) returns a exactly when a == b.
    size_t width = kCellCorners / 2;
    for (size_t axis = 4; axis-- > 0; width /= 2) {
      for (size_t m = 0; m < width; ++m) v[m] += local[axis] * (v[m + width] - v[m]);
    }
    out[channel] = v[0];
  }
  return out;
}

RayCoords LocalCoords(const CellId& cell, const RayCoords& coords) {
  const double cells = static_cast<double>(1 << cell.depth);
  RayCoords local;
  for (size_t k = 0; k < 4; ++k) {
    local[k] = std::clamp(coords[k] * cells - cell.index[k], 0.0, 1.0);
  }
  return local;
}

}  // namespace linetree
