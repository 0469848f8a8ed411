// Random cells of scenes: boxes in ray space about rays that meet an object.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/certify/path_certifier.h"
#include "tests/support/random_scene.h"

namespace linetree::test {

struct RandomCell {
  int object = 0;
  int pair = 0;
  CellBox box;

  // The ray at u in [0,1]^4 of the box.
  Ray At(const ObjectChart& chart, const RayCoords& u) const {
    RayCoords x;
    for (size_t i = 0; i < 4; ++i) x[i] = box.from[i] + u[i] * (box.to[i] - box.from[i]);
    return chart.LineOf(pair, x);
  }
};

// A cell of one object whose edges are `edge` of the object's own size, or nothing where the random
// ray has no coordinates.
inline std::optional<RandomCell> CellOf(const Tracer& tracer, const ObjectChart& chart, int object,
                                        double edge, Random& random) {
  const Box3& bounds = tracer.scene().objects[static_cast<size_t>(object)].bounds;
  const Vec3d eye = bounds.Center() + random.Direction() * (2 * Length(bounds.Extent()));
  const Vec3d target = random.InBox(bounds.min, bounds.max);
  const Vec3d direction = Normalized(target - eye);
  const Hit hit = tracer.IntersectObjectLine(object, eye, direction);
  if (!hit.IsHit()) return std::nullopt;
  RandomCell cell;
  cell.object = object;
  cell.pair = chart.PairOf(direction);
  const auto coords = chart.CoordsOf(cell.pair, hit.point, direction);
  if (!coords) return std::nullopt;
  for (size_t i = 0; i < 4; ++i) {
    // Somewhere about the ray, inside of [0, 1].
    const double from = (*coords)[i] - edge * random.Unit();
    cell.box.from[i] = std::clamp(from, 0.0, 1 - edge);
    cell.box.to[i] = cell.box.from[i] + edge;
  }
  return cell;
}

// Coordinates in a cell: corners, edges, the inside.
inline RayCoords RandomCoords(Random& random) {
  RayCoords u;
  for (double& x : u) x = random.Below(4) == 0 ? 0.5 * random.Below(3) : random.Unit();
  return u;
}

// What one cell knows of paths: its own steps, for the eye ray.
class OneCell : public PathLists {
 public:
  explicit OneCell(const CellPaths& paths) : paths_(paths) {}
  const PathStep* Find(const Hit& hit, const Vec3d&) const override {
    if (asked_) return nullptr;
    asked_ = true;
    return paths_.steps[0].EndsAt(hit) ? paths_.steps.data() : nullptr;
  }

 private:
  const CellPaths& paths_;
  mutable bool asked_ = false;
};
class NoLights : public LightLists {
 public:
  KnownLights Find(const Hit&) const override { return {}; }
};

}  // namespace linetree::test
