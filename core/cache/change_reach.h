// Which of what trees know of a scene a change of it may touch: an index over the segments that
// cells speak of.
#pragma once

#include <span>
#include <vector>

#include "core/certify/cell_paths.h"
#include "core/certify/path_tree.h"
#include "core/scene/scene_change.h"
#include "core/tree/surface_tree.h"

namespace linetree {

// What became of a former cache's cells.
struct Adopted {
  uint64_t kept = 0, dropped = 0;
};

class ChangeReach {
 public:
  // Keeps references to both.
  ChangeReach(const Scene& now, const SceneChange& change);

  const SceneChange& change() const { return change_; }

  // Whether a ray between two points of the boxes may come near a place of the change.
  bool Crosses(const Box3& from, const Box3& to) const;
  // The same of rays from the box to any light.
  bool CrossesToLights(const Box3& from) const;

  // Whether what a cell of the object's linetree knows may be wrong now. Indices in `paths` are
  // those of the former scene.
  bool Touches(const PathTree& tree, const PathNode& node) const;
  bool TouchesShadows(const SurfaceTree& tree, const SurfaceNode& node) const;

 private:
  bool Names(const CellPaths& paths) const;
  bool CrossesLegs(const CellPaths& paths, size_t step, const Box3& ends) const;

  const Scene& now_;
  const SceneChange& change_;
  Box3 world_;
  std::vector<Box3> places_;  // widened by rounding; one for all where there are many
};

// Writes the indices that the objects have now into what a cell knows; false where one of them is
// gone.
bool Renumber(std::span<const int32_t> now, CellLights& lights);
bool Renumber(std::span<const int32_t> now, CellPaths& paths);

}  // namespace linetree
