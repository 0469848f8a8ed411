// Makers of canonical shapes (shape.h) from the parameters of the scene file and an affine map from
// the shape's own coordinates to the world.
//
// Bad parameters come back as INVALID_ARGUMENT with a message "field: expected ..., got ...", where
// field is named as in the shape's message of scene.proto ("radius", "vertices[2]"), or is
// "transform" when the map is not invertible.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/scene/affine_map.h"
#include "core/scene/shape.h"

namespace linetree {

// Coordinates and lengths larger than this are refused, and so are lengths below its reciprocal:
// the tracer multiplies at most eight of them, which stays clear of overflow and underflow.
inline constexpr double kMaxMagnitude = 1e30;

absl::StatusOr<Shape> MakeSphere(const Vec3d& center, double radius, const AffineMap& map = {});
// Axis-aligned before the map.
absl::StatusOr<Shape> MakeEllipsoid(const Vec3d& center, const Vec3d& semi_axes,
                                    const AffineMap& map = {});
absl::StatusOr<Shape> MakeBox(const Vec3d& min, const Vec3d& max, const AffineMap& map = {});

// A cylinder or cone; object space has the base at z = 0 and the top at z = 1. One radius may be 0.
struct FrustumParameters {
  Vec3d base, top;
  double base_radius = 1;
  double top_radius = 1;
  bool open = false;
};
absl::StatusOr<Shape> MakeFrustum(const FrustumParameters& parameters, const AffineMap& map = {});

absl::StatusOr<Shape> MakeDisc(const Vec3d& center, const Vec3d& normal, double radius,
                               const AffineMap& map = {});

// Expects a planar, strictly simple convex loop of three vertices or more in either orientation
// (see planar_loop.h for the tolerances).
absl::StatusOr<Shape> MakeConvexPolygon(const std::vector<Vec3d>& vertices,
                                        const AffineMap& map = {});

// Three vertices; `normals` is empty (then the shape is a PolygonShape) or holds three non-zero
// vectors, which are carried by the inverse transpose of the map.
absl::StatusOr<Shape> MakeTriangle(const std::vector<Vec3d>& vertices,
                                   const std::vector<Vec3d>& normals, const AffineMap& map = {});

// Points with normal.x <= offset; the normal need not be of unit length.
struct HalfSpace {
  Vec3d normal;
  double offset = 0;
};
// Refuses what is unbounded or has no interior. Face i of the shape is half_spaces[i].
// Cost: O(n^3) at worst, about n^2 in practice.
absl::StatusOr<Shape> MakePolyhedron(const std::vector<HalfSpace>& half_spaces,
                                     const AffineMap& map = {});

// The rules that the makers share, for other readers of scene files.
// A finite vector of coordinates of magnitude at most kMaxMagnitude.
absl::Status CheckPoint(const std::string& field, const Vec3d& point);
// A finite length in [1 / kMaxMagnitude, kMaxMagnitude].
absl::Status CheckLength(const std::string& field, double length);
// Finite and not zero, of any length.
absl::Status CheckDirection(const std::string& field, const Vec3d& direction);

}  // namespace linetree
