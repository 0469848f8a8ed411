#include "core/certify/ray_bundle.h"

#include <algorithm>
#include <cmath>

#include "core/trace/intersect.h"
#include "core/tree/separation.h"

namespace linetree {
namespace {

Box3 Union(Box3 a, const Box3& b) {
  a.Add(b);
  return a;
}

}  // namespace

Box3 PointCloud::Bounds() const {
  Box3 box;
  for (const Vec3d& p : points) box.Add(p);
  for (int i = 0; i < 3; ++i) {
    box.min[i] -= slack;
    box.max[i] += slack;
  }
  return box;
}

bool PointCloud::IsFinite() const {
  return std::isfinite(slack) && std::all_of(points.begin(), points.end(),
                                             [](const Vec3d& p) { return linetree::IsFinite(p); });
}

RayBundle::RayBundle(const Scene& scene, const CandidateSearch& search, const RayStart& start,
                     const PointCloud& from, const PointCloud& to)
    : scene_(scene), search_(search), start_(start), from_(from.Bounds()), to_(to.Bounds()) {
  std::copy(from.points.begin(), from.points.end(), points_.begin());
  std::copy(to.points.begin(), to.points.end(), points_.begin() + 16);
  clearance_ = ClearanceOf(Union(from_, to_)) + std::max(from.slack, to.slack);
}

bool RayBundle::MayMeet(int object) const {
  const Shape& shape = scene_.objects[static_cast<size_t>(object)].shape;
  // A convex surface is not met again from outside; from inside it is the far side that is met.
  if (object == start_.object) return start_.side == Side::kInside;
  return !CertainlyApart(points_, shape, clearance_ + search_.Surplus(object));
}

std::vector<int32_t> RayBundle::Candidates(int target,
                                           const std::span<const int32_t>* inherited) const {
  const auto may_meet = [&](int object) { return object != target && MayMeet(object); };
  if (inherited != nullptr) return search_.Among(*inherited, may_meet);
  return search_.InShaft(from_, to_, clearance_, may_meet);
}

bool IsCertainlyInside(const PointCloud& cloud, const Shape& shape) {
  // The octahedron of radius sqrt(3) r about a point contains the ball of radius r.
  const double reach = std::sqrt(3.0) * (cloud.slack + ClearanceOf(cloud.Bounds()));
  return std::all_of(cloud.points.begin(), cloud.points.end(), [&](const Vec3d& p) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {-reach, reach}) {
        Vec3d corner = p;
        corner[axis] += sign;
        if (!ContainsStrictly(shape, corner)) return false;
      }
    }
    return true;
  });
}

bool IsCertainlyOutside(const PointCloud& cloud, const Shape& shape, double surplus) {
  return CertainlyApart(cloud.points, shape, cloud.slack + ClearanceOf(cloud.Bounds()) + surplus);
}

}  // namespace linetree
