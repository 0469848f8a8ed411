#include "core/certify/ray_bundle.h"

#include <algorithm>
#include <cmath>

#include "core/jet/interval.h"
#include "core/scene/support.h"
#include "core/trace/intersect.h"
#include "core/tree/separation.h"

namespace linetree {
namespace {

// A section nearer to an end than this share of the way says no more than the end does.
constexpr double kLeastCut = 1 / 64.0;

Box3 Union(Box3 a, const Box3& b) {
  a.Add(b);
  return a;
}

// Whether all segments from one cloud to the other are apart from the shape.
bool IsApart(const PointCloud& from, const PointCloud& to, const Shape& shape, double clearance) {
  std::array<Vec3d, 32> points;
  std::array<double, 32> radii;
  std::copy(from.points.begin(), from.points.end(), points.begin());
  std::copy(to.points.begin(), to.points.end(), points.begin() + 16);
  std::fill_n(radii.begin(), 16, from.slack);
  std::fill_n(radii.begin() + 16, 16, to.slack);
  return CertainlyApart(points, radii, shape, clearance);
}

Vec3d MiddleOf(const PointCloud& cloud) {
  Vec3d sum;
  for (const Vec3d& p : cloud.points) sum = sum + p;
  return sum * (1.0 / 16);
}

Interval RangeAlong(const PointCloud& cloud, const Vec3d& direction, const Vec3d& origin) {
  Interval range = {Box3::kInf, -Box3::kInf};
  for (const Vec3d& p : cloud.points) {
    const double at = Dot(direction, p - origin);
    range = {std::min(range.lo, at - cloud.slack), std::max(range.hi, at + cloud.slack)};
  }
  return range;
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
                     const PointCloud& from, const PointCloud& to, std::optional<Section> section)
    : scene_(scene),
      search_(search),
      start_(start),
      section_(section),
      begin_(from),
      end_(to),
      from_(from.Bounds()),
      to_(to.Bounds()),
      clearance_(ClearanceOf(Union(from_, to_))) {}

bool RayBundle::MayMeet(int object) const {
  const Shape& shape = scene_.objects[static_cast<size_t>(object)].shape;
  // A convex surface is not met again from outside; from inside it is the far side that is met.
  if (object == start_.object) return start_.side == Side::kInside;
  const double clearance = clearance_ + search_.Surplus(object);
  return !IsApart(begin_, end_, shape, clearance) && !IsApartInParts(shape, clearance);
}

// A plane across the way of the segments goes in front of the shape, and one behind it. Between
// them the sections say more than the clouds at the ends; beyond them the plane separates.
bool RayBundle::IsApartInParts(const Shape& shape, double clearance) const {
  if (!section_) return false;
  const Vec3d middle = MiddleOf(begin_);
  const Vec3d way = MiddleOf(end_) - middle;
  const double length = Length(way);
  if (!(length > 0)) return false;
  const Vec3d along = way * (1 / length);
  const Interval first = RangeAlong(begin_, along, middle), last = RangeAlong(end_, along, middle);
  const double before = -Support(shape, -along, middle) - clearance;
  const double behind = Support(shape, along, middle) + clearance;
  const double from = (before - first.hi) / (last.hi - first.hi);
  const double to = (behind - first.lo) / (last.lo - first.lo);
  const bool cuts_before = from > kLeastCut && from < 1 - kLeastCut;
  const bool cuts_behind = to > kLeastCut && to < 1 - kLeastCut;
  if (!cuts_before && !cuts_behind) return false;
  const PointCloud front = cuts_before ? (*section_)(from) : begin_;
  const PointCloud back = cuts_behind ? (*section_)(to) : end_;
  if (!front.IsFinite() || !back.IsFinite()) return false;
  return IsApart(front, back, shape, clearance) &&
         (!cuts_before || IsApart(begin_, front, shape, clearance)) &&
         (!cuts_behind || IsApart(back, end_, shape, clearance));
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
