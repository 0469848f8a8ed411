#include "core/certify/path_certifier.h"

namespace linetree {

CellBox BoxOf(const CellId& cell) {
  return {CoordsOfGrid(cell.Corner(0)), CoordsOfGrid(cell.Corner(kCellCorners - 1))};
}

PathCertifier::Context::Context(const Tracer& t)
    : tracer(t),
      scene(t.scene()),
      lights(t),
      world(scene.WorldBounds()),
      floor(RadianceFloor(scene)) {
  shapes.reserve(scene.objects.size());
  for (const Object& object : scene.objects) shapes.push_back(MakeJetShape(object));
}

PathCertifier::PathCertifier(const Tracer& tracer, Lanes lanes) : context_(tracer), lanes_(lanes) {}

CellPaths PathCertifier::Certify(int object, const ObjectChart& chart, int pair, const CellBox& box,
                                 const PathLimits& limits, const CellPaths* parent) const {
  Task task;
  task.object = object;
  task.form = chart.FormOf(pair);
  task.box = box;
  RayCoords middle;
  for (size_t i = 0; i < 4; ++i) middle[i] = (box.from[i] + box.to[i]) / 2;
  task.middle = chart.LineOf(pair, middle);
  task.limits = limits;
  task.parent = parent;
  return lanes_ == Lanes::kSimd ? CertifyPathsSimd(context_, task)
                                : CertifyPathsScalar(context_, task);
}

}  // namespace linetree
