// Who wants to hear of cells as they become known, and cells that somebody has kept: what a store
// needs of the caches. Cells are pure functions of the scene, so they may be kept for as long as
// the scene's content is the same.
#pragma once

#include <cstdint>
#include <memory>

#include "core/certify/cell_paths.h"
#include "core/trace/tracer.h"
#include "core/tree/cell.h"
#include "core/tree/light_certifier.h"
#include "core/tree/surface_chart.h"

namespace linetree {

// Which cell of a surface tree.
struct SurfacePlace {
  int32_t object = 0;
  int32_t patch = 0;
  SurfaceCell cell;
};

// Which cell of the certified linetrees of some path limits.
struct PathPlace {
  int32_t object = 0;
  int32_t pair = 0;
  CellId cell;
};

class CellJournal {
 public:
  virtual ~CellJournal() = default;
  // What has just been published. Calls of one kind come one at a time, outside the readers' lock;
  // they are short and do not ask the cache.
  virtual void Write(const SurfacePlace& place, const CellLights& lights) = 0;
  virtual void Write(const PathLimits& limits, const PathPlace& place, const CellPaths& paths) = 0;
};

// A cell that was kept. Lists name objects of the scene that it is given back to; everything in it
// has the form that certifiers give it.
struct KeptSurfaceCell {
  SurfacePlace place;
  std::unique_ptr<const CellLights> lights;
};
struct KeptPathCell {
  PathPlace place;
  std::unique_ptr<const CellPaths> paths;
};

}  // namespace linetree
