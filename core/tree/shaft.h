// A shaft: a convex set that holds every segment between two boxes (Haines and Wallace's shaft
// culling, as the paper's section 5.2 uses it).
#pragma once

#include <array>
#include <cstddef>

#include "core/math/box3.h"

namespace linetree {

// Rounding of a support value n.x of a box, relative to the sum of |n_i| |x_i| with the largest
// coordinates: two products (n has a zero) and two sums, each 2^-53; doubled.
inline constexpr double kShaftRounding = 0x1p-50;

class Shaft {
 public:
  // The convex hull of two boxes, neither of them empty.
  Shaft(const Box3& from, const Box3& to);

  // Whether the box certainly has no point in common with the hull. Never wrong when it says yes;
  // may say no although they are disjoint, because only axis-parallel planes and planes parallel
  // to one axis are tried, and where the gap is within kShaftRounding of the coordinates involved.
  bool Misses(const Box3& box) const;

 private:
  // Across one axis: ni x_i + nj x_j <= offset on the hull.
  struct HalfSpace {
    int i, j;
    double ni, nj;
    double offset;
    double magnitude;  // of the hull along the normal, for rounding
  };
  Box3 hull_bounds_;
  // One for each pair of axes and each like corner, at most.
  std::array<HalfSpace, 12> sides_;
  size_t side_count_ = 0;
};

}  // namespace linetree
