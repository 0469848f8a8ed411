#include "core/tree/cell.h"

#include <algorithm>

namespace linetree {

CellId CellAt(const RayCoords& coords, int depth) {
  CellId id;
  id.depth = static_cast<uint8_t>(depth);
  const int cells = 1 << depth;
  for (size_t k = 0; k < 4; ++k) {
    const int i = static_cast<int>(coords[k] * cells);
    id.index[k] = static_cast<uint16_t>(std::clamp(i, 0, cells - 1));
  }
  return id;
}

}  // namespace linetree
