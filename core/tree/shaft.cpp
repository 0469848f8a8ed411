#include "core/tree/shaft.h"

#include <algorithm>

namespace linetree {
namespace {

// Of ni x_i + nj x_j over a box: the largest value, and what bounds all of it for rounding.
double Sup(const Box3& b, int i, int j, double ni, double nj) {
  return (ni > 0 ? b.max[i] : b.min[i]) * ni + (nj > 0 ? b.max[j] : b.min[j]) * nj;
}
// The largest size of each coordinate.
Vec3d ReachOf(const Box3& b) {
  Vec3d reach;
  for (int i = 0; i < 3; ++i) reach[i] = std::max(std::abs(b.min[i]), std::abs(b.max[i]));
  return reach;
}
double Magnitude(const Vec3d& reach, int i, int j, double ni, double nj) {
  return std::abs(ni) * reach[i] + std::abs(nj) * reach[j];
}

}  // namespace

Shaft::Shaft(const Box3& from, const Box3& to) : hull_bounds_(from) {
  hull_bounds_.Add(to);
  const Vec3d reach = ReachOf(hull_bounds_);
  // Seen along an axis, the hull of two rectangles has edges that join like corners. For each pair
  // of coordinates (i, j) and each of the four like corners, the line through both is a candidate;
  // it bounds the hull on the side where both boxes lie.
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    for (int corner = 0; corner < 4; ++corner) {
      const auto pick = [&](const Box3& b, int axis, int bit) {
        return (corner & bit) != 0 ? b.max[axis] : b.min[axis];
      };
      const double di = pick(to, i, 1) - pick(from, i, 1);
      const double dj = pick(to, j, 2) - pick(from, j, 2);
      if (di == 0 || dj == 0) continue;  // axis-parallel: the bounding box has it
      // Tangent to both boxes iff the like corner is the supporting one.
      const bool is_right = (corner & 1) != 0, is_upper = (corner & 2) != 0;
      const bool supports = is_right == (dj < 0) && is_upper == (di > 0);
      const bool opposite_supports = is_right == (dj > 0) && is_upper == (di < 0);
      if (!supports && !opposite_supports) continue;
      const double ni = supports ? -dj : dj, nj = supports ? di : -di;
      sides_[side_count_++] = {i,
                               j,
                               ni,
                               nj,
                               std::max(Sup(from, i, j, ni, nj), Sup(to, i, j, ni, nj)),
                               Magnitude(reach, i, j, ni, nj)};
    }
  }
}

bool Shaft::Misses(const Box3& box) const {
  if (!hull_bounds_.Overlaps(box)) return true;
  const Vec3d reach = ReachOf(box);
  const auto end = sides_.begin() + static_cast<std::ptrdiff_t>(side_count_);
  return std::any_of(sides_.begin(), end, [&](const HalfSpace& side) {
    const auto& [i, j, ni, nj, offset, magnitude] = side;
    const double slack = kShaftRounding * (Magnitude(reach, i, j, ni, nj) + magnitude);
    return -Sup(box, i, j, -ni, -nj) > offset + slack;
  });
}

}  // namespace linetree
