// What a bundle of segments may meet. Every segment runs from a point of one set to a point of
// another, so all of them lie in the convex hull of both: an object that is certainly apart from
// that hull is met by none of them, whether mirrors on the way were flat, curved or of glass.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math/box3.h"
#include "core/trace/hit.h"
#include "core/tree/candidate_search.h"

namespace linetree {

// conv(points), widened by `slack` on all sides.
struct PointCloud {
  std::array<Vec3d, 16> points;
  double slack = 0;

  Box3 Bounds() const;
  bool IsFinite() const;
};

class RayBundle {
 public:
  RayBundle(const Scene& scene, const CandidateSearch& search, const RayStart& start,
            const PointCloud& from, const PointCloud& to);

  // The objects that some segment may meet, other than `target`; of `inherited` objects only when
  // that is not null. As CandidateSearch: ascending, kMaxCandidates + 1 means too many.
  std::vector<int32_t> Candidates(int target, const std::span<const int32_t>* inherited) const;

 private:
  bool MayMeet(int object) const;

  const Scene& scene_;
  const CandidateSearch& search_;
  const RayStart start_;
  std::array<Vec3d, 32> points_;
  Box3 from_, to_;
  double clearance_;  // the clouds' slack included
};

// Whether the cloud certainly lies inside a solid, or certainly outside.
bool IsCertainlyInside(const PointCloud& cloud, const Shape& shape);
bool IsCertainlyOutside(const PointCloud& cloud, const Shape& shape, double surplus);

}  // namespace linetree
