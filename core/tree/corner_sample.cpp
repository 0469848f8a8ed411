#include "core/tree/corner_sample.h"

namespace linetree {

CornerSample TraceCorner(const Tracer& tracer, int object, const ObjectChart& chart, int pair,
                         const RayCoords& coords, const PathLimits& limits, RayCounts& counts) {
  CornerSample sample;
  const Ray line = chart.LineOf(pair, coords);
  ++counts.intersect;
  const Hit hit = tracer.IntersectObjectLine(object, line.origin, line.direction);
  if (!hit.IsHit()) return sample;
  sample.hits = true;
  sample.tree.radiance =
      tracer.RadianceFromHit(hit, line.origin, line.direction, limits, counts, &sample.tree);
  sample.tree.nodes.shrink_to_fit();
  sample.tree.lights.shrink_to_fit();
  return sample;
}

}  // namespace linetree
