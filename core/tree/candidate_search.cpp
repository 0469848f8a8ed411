#include "core/tree/candidate_search.h"

#include <cmath>

namespace linetree {
namespace {

double Magnitude(const Box3& box) {
  double largest = 0;
  for (int i = 0; i < 3; ++i) {
    largest = std::max({largest, std::abs(box.min[i]), std::abs(box.max[i])});
  }
  return largest;
}

// Rays use a shape's map into object space, supports the one out of it, and the two are inverse up
// to rounding only; a polyhedron's vertices stand for its half-spaces up to kVertexMerge.
constexpr double kVertexMerge = 0x1p-34;

const AffineFrame* FrameOf(const Shape& shape) {
  if (const auto* s = std::get_if<SphereShape>(&shape)) return &s->frame;
  if (const auto* s = std::get_if<BoxShape>(&shape)) return &s->frame;
  if (const auto* s = std::get_if<FrustumShape>(&shape)) return &s->frame;
  if (const auto* s = std::get_if<DiscShape>(&shape)) return &s->frame;
  return nullptr;
}

}  // namespace

double SurplusOf(const Object& object) {
  const double size = Length(object.bounds.Extent());
  const AffineFrame* frame = FrameOf(object.shape);
  if (frame == nullptr) return kVertexMerge * (size + Magnitude(object.bounds));
  double deviation = 0;
  for (int i = 0; i < 3; ++i) {
    Vec3d unit;
    unit[i] = 1;
    deviation += Length(frame->world_from_object * (frame->object_from_world * unit) - unit);
  }
  return 2 * deviation * size;
}

double ClearanceOf(const Box3& box) { return kClearance * (Length(box.Extent()) + Magnitude(box)); }

CandidateSearch::CandidateSearch(const Tracer& tracer) : tracer_(tracer) {
  const Scene& scene = tracer.scene();
  surplus_.reserve(scene.objects.size());
  for (const Object& object : scene.objects) surplus_.push_back(SurplusOf(object));
}

Box3 CandidateSearch::Widened(Box3 box, double clearance) {
  for (int i = 0; i < 3; ++i) {
    box.min[i] -= clearance;
    box.max[i] += clearance;
  }
  return box;
}

}  // namespace linetree
