// One extremal ray, traced: what the judge compares and the interpolant stores.
#pragma once

#include "core/trace/ray_tree.h"
#include "core/trace/tracer.h"
#include "core/tree/ray_space.h"

namespace linetree {

// Immutable once made, so cells of all requests may share it.
struct CornerSample {
  bool hits = false;  // whether the line meets the object at all
  RayTree tree;       // of the line's first crossing with the object; empty unless hits

  size_t ByteSize() const { return sizeof(CornerSample) + tree.ByteSize(); }
};

// Traces the line with the given coordinates, as seen from outside. Adds one Intersect for the line
// itself and what its shading costs.
CornerSample TraceCorner(const Tracer& tracer, int object, const ObjectChart& chart, int pair,
                         const RayCoords& coords, const PathLimits& limits, RayCounts& counts);

}  // namespace linetree
