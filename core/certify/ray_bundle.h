// What a bundle of segments may meet. Every segment runs from a point of one set to a point of
// another, so all of them lie in the convex hull of both: an object that is certainly apart from
// that hull is met by none of them, whether mirrors on the way were flat, curved or of glass.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "absl/functional/function_ref.h"
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
  // Where the segments are when they have gone this share of their way, in (0, 1): the points
  // a + share (b - a) for the segments a b that there are. Less than what the clouds at their ends
  // say, which is as if every point of the one went to every point of the other.
  using Section = absl::FunctionRef<PointCloud(double share)>;

  RayBundle(const Scene& scene, const CandidateSearch& search, const RayStart& start,
            const PointCloud& from, const PointCloud& to,
            std::optional<Section> section = std::nullopt);

  // The objects that some segment may meet, other than `target`; of `inherited` objects only when
  // that is not null. As CandidateSearch: ascending, kMaxCandidates + 1 means too many.
  std::vector<int32_t> Candidates(int target, const std::span<const int32_t>* inherited) const;

 private:
  bool MayMeet(int object) const;
  // Whether the shape is apart from the segments when they are cut before it and behind it.
  bool IsApartInParts(const Shape& shape, double clearance) const;

  const Scene& scene_;
  const CandidateSearch& search_;
  const RayStart start_;
  const std::optional<Section> section_;
  const PointCloud begin_, end_;
  Box3 from_, to_;
  double clearance_;
};

// Whether the cloud certainly lies inside a solid, or certainly outside.
bool IsCertainlyInside(const PointCloud& cloud, const Shape& shape);
bool IsCertainlyOutside(const PointCloud& cloud, const Shape& shape, double surplus);

}  // namespace linetree
