#include "core/tree/shaft.h"

#include <algorithm>

namespace linetree {
namespace {

// Largest and smallest n.x over a box.
double Sup(const Box3& b, const Vec3d& n) {
  return (n.x > 0 ? b.max.x : b.min.x) * n.x + (n.y > 0 ? b.max.y : b.min.y) * n.y +
         (n.z > 0 ? b.max.z : b.min.z) * n.z;
}
double Inf(const Box3& b, const Vec3d& n) { return -Sup(b, -n); }

double Magnitude(const Box3& b, const Vec3d& n) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    sum += std::abs(n[i]) * std::max(std::abs(b.min[i]), std::abs(b.max[i]));
  }
  return sum;
}

}  // namespace

Shaft::Shaft(const Box3& from, const Box3& to) : hull_bounds_(from) {
  hull_bounds_.Add(to);
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
      Vec3d n;
      n[i] = -dj;
      n[j] = di;
      for (const Vec3d& normal : {n, -n}) {
        // Tangent to both boxes iff the like corner is the supporting one.
        const bool supports =
            ((corner & 1) != 0) == (normal[i] > 0) && ((corner & 2) != 0) == (normal[j] > 0);
        if (!supports) continue;
        sides_[side_count_++] = {normal, std::max(Sup(from, normal), Sup(to, normal)),
                                 Magnitude(hull_bounds_, normal)};
      }
    }
  }
}

bool Shaft::Misses(const Box3& box) const {
  if (!hull_bounds_.Overlaps(box)) return true;
  const auto end = sides_.begin() + static_cast<std::ptrdiff_t>(side_count_);
  return std::any_of(sides_.begin(), end, [&](const HalfSpace& side) {
    const double slack = kShaftRounding * (Magnitude(box, side.normal) + side.magnitude);
    return Inf(box, side.normal) > side.offset + slack;
  });
}

}  // namespace linetree
