// Which transparent solids surround a point: the other side of every refracting surface.
//
// The index outside an object K at a point x of its surface is that of the innermost other
// transparent solid that contains x strictly (innermost: smallest volume of its bounds; ties:
// larger index), or 1. This depends on K and x alone, not on how the ray got there.
//
// Thread safety: immutable once built.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/math/vec3.h"
#include "core/scene/scene.h"

namespace linetree {

class Media {
 public:
  explicit Media(const Scene& scene);

  // Index of refraction around transparent solid `object` of the scene at `point` of its surface.
  template <class S>
  double IorAround(const Scene& scene, int object, const Vec3<S>& point) const;

  // The transparent solids, innermost first, of which IorAround takes the first that contains the
  // point.
  std::span<const int32_t> Neighbours(int object) const {
    const auto found = neighbours_.find(object);
    if (found == neighbours_.end()) return {};
    return found->second;
  }

 private:
  // Transparent solids whose bounds overlap the key's, innermost first; absent when there are none.
  std::unordered_map<int32_t, std::vector<int32_t>> neighbours_;
};

}  // namespace linetree
