// The planes that an object lies behind: what a light in front of one of them sees of it.
#pragma once

#include <vector>

#include "core/scene/shape.h"

namespace linetree {

// World space; unit normals that point outwards, taken from what rays meet (object_from_world,
// planes and edges), not from vertices or world_from_object.
struct FacePlanes {
  // Boxes and polyhedra: all faces, in their order. Frustums: both caps. Planar shapes: their
  // plane, which has the shape behind it either way. Spheres: none.
  std::vector<Plane> faces;
  // Polygons and triangles: across the plane through the edges.
  std::vector<Plane> edges;
  bool is_planar = false;
};

FacePlanes FacePlanesOf(const Shape& shape);

}  // namespace linetree
