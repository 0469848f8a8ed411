// Shapes of the scene as packets search them.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "core/packet/packet_scene.h"

namespace linetree {

inline float RoundedDown(double x) {
  const float f = static_cast<float>(x);
  return f > x ? std::nextafterf(f, -std::numeric_limits<float>::infinity()) : f;
}
inline float RoundedUp(double x) { return -RoundedDown(-x); }

// All but `opaque`. Appends the planes of polygons and polyhedra.
PacketShape MakePacketShape(const Object& object, int32_t index, const Vec3d& reference,
                            std::vector<FloatPlane>& planes);

}  // namespace linetree
