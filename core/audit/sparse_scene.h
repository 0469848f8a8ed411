// Random scenes of solids and polygons that keep apart, over a floor: the field in which certified
// cells are compared with each other and with the paper's.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

#include "core/scene/scene.h"

namespace linetree {

// Both: spheres, boxes, cylinders and polygons of sizes 0.3 to 1.1 in a cube of edge 6 over a floor
// that may have a wall, no two of whose bounding spheres meet, and one to three point lights above.
enum class SparseFamily {
  // Of four materials one is matte, the others are glossy, mirrors or glass.
  kEven,
  // Fewer materials that send rays on: 30 % matte, 30 % glossy, 22 % mirrors, 18 % glass, but every
  // second floor and wall is a mirror; ellipsoids among the shapes.
  kOpaque,
};
inline constexpr std::array<std::string_view, 2> kSparseFamilyNames = {"even", "opaque"};

// A pure function of family and seed.
std::shared_ptr<const Scene> MakeSparseScene(SparseFamily family, uint64_t seed);

}  // namespace linetree
