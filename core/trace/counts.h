// Ray counters: returned values that callers sum; nothing global.
#pragma once

#include <cstdint>

namespace linetree {

struct RayCounts {
  uint64_t eye = 0;
  uint64_t reflected = 0;  // total internal reflection included
  uint64_t refracted = 0;
  uint64_t shadow = 0;
  // Answered without a search of the scene: of the shadow rays (LightLists), and of the reflected
  // and refracted ones (PathLists).
  uint64_t listed = 0;
  uint64_t listed_branches = 0;
  uint64_t summed = 0;  // surfaces whose diffuse light came from KnownLights::diffuse
  // The paper's section 8: Intersect is a ray-scene intersection (of any kind of ray but
  // listed ones), Shade a radiance computation at a point.
  uint64_t intersect = 0;
  uint64_t shade = 0;

  RayCounts& operator+=(const RayCounts& o) {
    eye += o.eye;
    reflected += o.reflected;
    refracted += o.refracted;
    shadow += o.shadow;
    listed += o.listed;
    listed_branches += o.listed_branches;
    summed += o.summed;
    intersect += o.intersect;
    shade += o.shade;
    return *this;
  }
  bool operator==(const RayCounts&) const = default;
};

}  // namespace linetree
