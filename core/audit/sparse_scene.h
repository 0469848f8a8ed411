// Random scenes of solids and polygons that keep apart, over a floor: the field in which certified
// cells are compared with each other and with the paper's.
#pragma once

#include <cstdint>
#include <memory>

#include "core/scene/scene.h"

namespace linetree {

// Spheres, boxes, cylinders and polygons of sizes 0.3 to 1.1 in a cube of edge 6; no two of their
// bounding spheres meet. Of four materials one is matte, the others are glossy, mirrors or glass.
// One to three point lights above. A pure function of the seed.
std::shared_ptr<const Scene> MakeSparseScene(uint64_t seed);

}  // namespace linetree
