// Axis-aligned boxes in world space.
#pragma once

#include <algorithm>
#include <limits>

#include "core/math/vec3.h"

namespace linetree {

// Empty when min > max on some axis; the default is empty.
struct Box3 {
  Vec3d min{kInf, kInf, kInf};
  Vec3d max{-kInf, -kInf, -kInf};

  static constexpr double kInf = std::numeric_limits<double>::infinity();

  bool IsEmpty() const { return min.x > max.x || min.y > max.y || min.z > max.z; }
  Vec3d Center() const { return (min + max) * 0.5; }
  Vec3d Extent() const { return max - min; }
  void Add(const Vec3d& p) {
    for (int i = 0; i < 3; ++i) {
      min[i] = std::min(min[i], p[i]);
      max[i] = std::max(max[i], p[i]);
    }
  }
  void Add(const Box3& b) {
    for (int i = 0; i < 3; ++i) {
      min[i] = std::min(min[i], b.min[i]);
      max[i] = std::max(max[i], b.max[i]);
    }
  }
  bool Contains(const Vec3d& p) const {
    return p.x >= min.x && p.x <= max.x && p.y >= min.y && p.y <= max.y && p.z >= min.z &&
           p.z <= max.z;
  }
  bool Overlaps(const Box3& b) const {
    return min.x <= b.max.x && b.min.x <= max.x && min.y <= b.max.y && b.min.y <= max.y &&
           min.z <= b.max.z && b.min.z <= max.z;
  }
  double HalfArea() const {
    const Vec3d e = Extent();
    return IsEmpty() ? 0 : e.x * e.y + e.y * e.z + e.z * e.x;
  }
  bool operator==(const Box3&) const = default;
};

}  // namespace linetree
