#include "core/render/frame.h"

namespace linetree {

FrameStats& FrameStats::operator+=(const FrameStats& o) {
  pixels += o.pixels;
  interpolated += o.interpolated;
  traced += o.traced;
  replayed += o.replayed;
  residual += o.residual;
  background += o.background;
  base += o.base;
  ip += o.ip;
  for (size_t v = 0; v < verdicts.size(); ++v) verdicts[v] += o.verdicts[v];
  cells_tried += o.cells_tried;
  cells_accepted += o.cells_accepted;
  cells_unkept += o.cells_unkept;
  cells_evicted += o.cells_evicted;
  cache_bytes = o.cache_bytes;
  wall_ms += o.wall_ms;
  cpu_ms += o.cpu_ms;
  return *this;
}

}  // namespace linetree
