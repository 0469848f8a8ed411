#include "core/cache/change_reach.h"

#include <array>
#include <optional>

#include "core/tree/candidate_search.h"
#include "core/tree/shaft.h"

namespace linetree {
namespace {

// More places are taken for one.
constexpr size_t kMaxPlaces = 16;

Box3 Widened(Box3 box, double by) {
  for (int axis = 0; axis < 3; ++axis) {
    box.min[axis] -= by;
    box.max[axis] += by;
  }
  return box;
}

Box3 Together(Box3 a, const Box3& b) {
  a.Add(b);
  return a;
}

// Where rays of the cell can meet the object: points of a line are affine in its coordinates, so
// every axis is by itself, and within rounding the box is that of the corners.
Box3 EndsOf(const PathTree& tree, const PathNode& node) {
  const LineForm form = tree.chart().FormOf(node.root);
  const RayCoords low = CoordsOfGrid(node.cell.Corner(0));
  const RayCoords high = CoordsOfGrid(node.cell.Corner(kCellCorners - 1));
  const auto box_of = [&](const Vec3d& at, const std::array<Vec3d, 4>& by) {
    Box3 box;
    box.Add(at);
    for (size_t k = 0; k < 4; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        const double a = by[k][axis] * low[k], b = by[k][axis] * high[k];
        box.min[axis] += std::min(a, b);
        box.max[axis] += std::max(a, b);
      }
    }
    return box;
  };
  Box3 box = box_of(form.origin, form.origin_by);
  if (form.between_planes) {
    std::array<Vec3d, 4> by;
    for (size_t k = 0; k < 4; ++k) by[k] = form.origin_by[k] + form.direction_by[k];
    box.Add(box_of(form.origin + form.direction, by));
  }
  return box;
}

// False where it is gone.
bool Renumber(std::span<const int32_t> now, int32_t& object) {
  if (object == kNoObject) return true;
  object = now[static_cast<size_t>(object)];
  return object != SceneChange::kGone;
}

}  // namespace

ChangeReach::ChangeReach(const Scene& now, const SceneChange& change)
    : now_(now), change_(change), world_(now.WorldBounds()) {
  // The largest that any shape may have: the shape that a place came from may be gone.
  double surplus = 0;
  for (const Object& object : now.objects) surplus = std::max(surplus, SurplusOf(object));
  for (const Box3& place : change.places) world_.Add(place);
  for (const Box3& place : change.places) {
    const Box3 wide = Widened(place, surplus + ClearanceOf(world_));
    if (places_.size() < kMaxPlaces) {
      places_.push_back(wide);
    } else {
      places_.front().Add(wide);
    }
  }
}

bool ChangeReach::Crosses(const Box3& from, const Box3& to) const {
  const Box3 both = Together(from, to);
  const double clearance = ClearanceOf(both);
  std::optional<Shaft> shaft;  // most places are far off
  for (const Box3& place : places_) {
    const Box3 wide = Widened(place, clearance);
    if (!wide.Overlaps(both)) continue;
    if (!shaft) shaft.emplace(from, to);
    if (!shaft->Misses(wide)) return true;
  }
  return false;
}

bool ChangeReach::CrossesToLights(const Box3& from) const {
  for (const Light& light : now_.lights) {
    Box3 to;
    if (light.kind == LightKind::kPoint) {
      to.Add(light.position);
    } else {
      const double reach = Length(world_.Extent()) + Length(from.Center() - world_.Center());
      to.Add(from.min + light.to_light * reach);
      to.Add(from.max + light.to_light * reach);
    }
    if (Crosses(from, to)) return true;
  }
  return false;
}

bool ChangeReach::TouchesShadows(const Object& object) const {
  return CrossesToLights(object.bounds);
}

bool ChangeReach::TouchesShadows(const SurfaceTree& tree, const SurfaceNode& node) const {
  Box3 piece;
  for (const Vec3d& p : tree.chart().HullOf(node.root, node.cell).points) piece.Add(p);
  return CrossesToLights(piece);
}

bool ChangeReach::Names(const CellPaths& paths) const {
  const auto is_other = [&](int32_t object) {
    if (object == kNoObject) return false;
    const auto i = static_cast<size_t>(object);
    return change_.now[i] == SceneChange::kGone || change_.altered[i];
  };
  for (const PathStep& step : paths.steps) {
    if (is_other(step.object)) return true;
  }
  return std::any_of(paths.objects.begin(), paths.objects.end(), is_other);
}

// The rays that leave from where those of the step end. Where these end is known by object; those
// that leave the scene may meet anything new. Legs without a list count as well: what they lead to
// depends on their directions, and these on the solids around their ends.
bool ChangeReach::CrossesLegs(const CellPaths& paths, size_t step, const Box3& ends) const {
  for (const int32_t ahead : {paths.steps[step].reflected, paths.steps[step].transmitted}) {
    if (ahead == 0) continue;
    const size_t next = step + static_cast<size_t>(ahead);
    const PathStep& leg = paths.steps[next];
    if (leg.object == kNoObject) {
      if (leg.listed) return true;
      continue;
    }
    const auto object = static_cast<size_t>(change_.now[static_cast<size_t>(leg.object)]);
    const Box3& target = now_.objects[object].bounds;
    if (Crosses(ends, target)) return true;
    if (paths.interpolant && CrossesToLights(target)) return true;
    if (CrossesLegs(paths, next, target)) return true;
  }
  return false;
}

bool ChangeReach::Touches(const PathTree& tree, const PathNode& node) const {
  const CellPaths& paths = *node.payload;
  if (paths.steps.empty()) return true;  // little is lost, and it may know more now
  if (paths.interpolant && change_.radiance) return true;
  if (Names(paths)) return true;
  if (places_.empty()) return false;
  const Box3 ends = EndsOf(tree, node);
  return (paths.interpolant && CrossesToLights(ends)) || CrossesLegs(paths, 0, ends);
}

bool Renumber(std::span<const int32_t> now, CellLights& lights) {
  bool all = true;
  for (LightList& light : lights.lights) all &= Renumber(now, light.occluder);
  for (int32_t& object : lights.objects) all &= Renumber(now, object);
  return all;
}

bool Renumber(std::span<const int32_t> now, CellPaths& paths) {
  bool all = true;
  for (PathStep& step : paths.steps) all &= Renumber(now, step.object);
  for (int32_t& object : paths.objects) all &= Renumber(now, object);
  return all;
}

}  // namespace linetree
