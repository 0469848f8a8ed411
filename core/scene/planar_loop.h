// Closed loops of vertices in one plane: what a polygon of a scene file is before it is known to be
// convex.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/math/vec3.h"

namespace linetree {

// How far vertices may lie from their plane, relative to the largest magnitude of a coordinate:
// files with six significant digits (NFF) are off by 5e-6 per coordinate, and so is the plane.
inline constexpr double kPlanarityTolerance = 2e-5;

// Vertices that are closer to each other, or to the line through their neighbours, than
// LoopTolerance are one vertex, or none; a loop that is thinner is degenerate. It is a thousand
// roundings of double arithmetic on the loop's extent and sixteen on the magnitude of its
// coordinates: signs of areas that clear it are certain.
inline constexpr double kLoopTolerance = 0x1p-42;
inline constexpr double kMagnitudeTolerance = 0x1p-48;
double LoopTolerance(const std::vector<Vec3d>& vertices);

struct PlanarLoop {
  std::vector<Vec3d> vertices;  // moved into the plane; no repeated or collinear neighbours
  Vec3d normal;                 // unit; the loop runs counter-clockwise about it
  bool convex = false;          // strictly, and winds once
};

// INVALID_ARGUMENT "vertices: expected ..." for fewer than three vertices, infinite ones, loops
// without area and loops that are not planar. Whether the loop crosses itself is not looked at.
absl::StatusOr<PlanarLoop> MakePlanarLoop(const std::vector<Vec3d>& vertices);

// Twice the area, along the normal about which the loop runs counter-clockwise.
Vec3d AreaVector(const std::vector<Vec3d>& vertices);

}  // namespace linetree
