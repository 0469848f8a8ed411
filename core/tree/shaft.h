// A shaft: a convex set that holds every segment between two boxes (Haines and Wallace's shaft
// culling, as the paper's section 5.2 uses it).
#pragma once

#include <array>
#include <cstddef>

#include "core/math/box3.h"

namespace linetree {

class Shaft {
 public:
  // The convex hull of two boxes, neither of them empty.
  Shaft(const Box3& from, const Box3& to);

  // Whether the box certainly has no point in common with the hull. Never wrong when it says yes
  // (but for rounding of kShaftRounding of the sizes involved); may say no although they are
  // disjoint, because only axis-parallel planes and planes parallel to one axis are tried.
  bool Misses(const Box3& box) const;

 private:
  // normal.x <= offset on the hull.
  struct HalfSpace {
    Vec3d normal;
    double offset;
    double magnitude;  // of the hull along the normal, for rounding
  };
  Box3 hull_bounds_;
  // One for each pair of axes and each like corner, at most.
  std::array<HalfSpace, 12> sides_;
  size_t side_count_ = 0;
};

}  // namespace linetree
