#include "core/certify/solid_interiors.h"

namespace linetree {
namespace {

Box3 Widened(Box3 box, double by) {
  for (int axis = 0; axis < 3; ++axis) {
    box.min[axis] -= by;
    box.max[axis] += by;
  }
  return box;
}

// The crossing of a ray in the room with any object lies by less than `clearance` outside the
// object's bounds, however it is rounded; for objects whose support deviates, by its surplus more,
// of which none exceeds `max_surplus`.
SolidInterior InteriorOf(const Tracer& tracer, const CandidateSearch& search, int object,
                         double clearance, double max_surplus) {
  const Scene& scene = tracer.scene();
  const Object& solid = scene.objects[static_cast<size_t>(object)];
  if (IsBlack(scene.MaterialOf(object).transmit) || !IsSolid(solid.shape)) return {};
  SolidInterior interior;
  interior.room = Widened(solid.bounds, search.Surplus(object) + ClearanceOf(solid.bounds));
  const auto may_meet = [&](int other) {
    const Box3& bounds = scene.objects[static_cast<size_t>(other)].bounds;
    return interior.room.Overlaps(Widened(bounds, search.Surplus(other) + clearance));
  };
  interior.candidates =
      search.InShaft(interior.room, interior.room, clearance + max_surplus, may_meet);
  if (interior.candidates.size() > kMaxCandidates) interior.candidates.clear();
  interior.candidates.shrink_to_fit();
  return interior;
}

}  // namespace

SolidInteriors::SolidInteriors(const Tracer& tracer) {
  const Scene& scene = tracer.scene();
  const CandidateSearch search(tracer);
  const double clearance = ClearanceOf(scene.WorldBounds());
  const int count = static_cast<int>(scene.objects.size());
  double max_surplus = 0;
  for (int i = 0; i < count; ++i) max_surplus = std::max(max_surplus, search.Surplus(i));
  for (int i = 0; i < count; ++i) {
    interiors_.push_back(InteriorOf(tracer, search, i, clearance, max_surplus));
  }
}

}  // namespace linetree
