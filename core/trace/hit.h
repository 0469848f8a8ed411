// What rays meet, and how spawned rays leave.
//
// No ray is ever offset. A ray that leaves a surface remembers the surface and the side it leaves
// on (RayStart), and the object excludes the start combinatorially: a ray leaving a convex object's
// outside cannot meet it again; a ray inside meets only the far side.
#pragma once

#include "core/math/vec3.h"

namespace linetree {

inline constexpr int kNoObject = -1;

enum class Side : unsigned char {
  kOutside,  // of a solid or open frustum; either side of a planar shape
  kInside,
};

// Where a ray starts. Free: anywhere (eye rays). Otherwise on `face` of `object`, leaving into
// `side`.
struct RayStart {
  int object = kNoObject;
  int face = 0;
  Side side = Side::kOutside;
};

// Nearest surface met by the ray o + t d, t > 0.
template <class S>
struct HitOf {
  int object = kNoObject;
  int face = 0;
  // The side of the surface that the ray comes from; kInside only on solids and open frustums.
  Side side = Side::kOutside;
  // Whether this is the first crossing of the object along the whole line, also behind the origin.
  // Only such a hit may be answered by a linetree, whose rays come from infinity.
  bool first_on_line = true;
  S t{};           // in units of the direction's length
  Vec3<S> point;   // world
  Vec3<S> normal;  // unit, turned towards the ray's origin: normal.d <= 0

  bool IsHit() const { return object != kNoObject; }
};
using Hit = HitOf<double>;

}  // namespace linetree
