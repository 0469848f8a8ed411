// Support functions: how far the convex hull of a shape reaches along a direction. World space.
//
// The shape is what its parameters say: affine shapes are the images of their canonical sets under
// world_from_object (open frustums: with their caps, which the hull fills), polygons, triangles and
// polyhedra are spanned by their vertices. Rays meet the same sets through object_from_world,
// planes and edges, but for the rounding with which make_shape.h derives one from the other (for
// polyhedra up to 2^-36 of their coordinates, the distance at which vertices are merged): callers
// who must agree with rays leave a margin for that.
//
// Every function takes an origin, the world's unless given, and speaks of x - origin: with an
// origin near the shape nothing is lost by the shape being far from the world's origin.
#pragma once

#include "core/math/vec3.h"
#include "core/scene/shape.h"

namespace linetree {

// sup n.(x - origin) over the hull, to within kSupportRounding * |n| * Reach(shape, origin). The
// length of n is 0 or in [1e-60, 1e60].
double Support(const Shape& shape, const Vec3d& n, const Vec3d& origin = {});

// x - origin for a point x of the hull where the supremum is reached. Any non-zero, finite
// direction. n.SupportPoint is Support to within 2 kSupportRounding * |n| * Reach.
Vec3d SupportPoint(const Shape& shape, const Vec3d& direction, const Vec3d& origin = {});

// x - origin for some point x of the hull that is near its middle.
Vec3d MiddleOf(const Shape& shape, const Vec3d& origin = {});

// An upper bound of |x - origin| over the hull, at most twice too large or so: |center - origin| +
// the lengths of the images of the object axes, or the farthest vertex (in the sum of coordinates).
double Reach(const Shape& shape, const Vec3d& origin = {});

// 16 roundings of 2^-53. A box needs the most: 3 for every component of the gradient in object
// space (5.2 for the three together, by sum <= sqrt(3) * norm), 2 for their sum, 4 for
// n.(center - origin), 1 for the total.
inline constexpr double kSupportRounding = 0x1p-49;

}  // namespace linetree
