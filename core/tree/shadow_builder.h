// Builds shadow functions (shadow_function.h): which points of a planar cell an object hides a
// light from (DESIGN, section 5: exact shadow functions).
//
// Algebra. Let d be the height above a plane, linear in the cell's coordinates, and e > 0 its value
// at the light (for a directional light n.l, its change along the way). A shadow ray from a point
// with d < 0 crosses the plane at t = d / (d - e), where another linear function g with the light's
// value g' has the value (g (-e) + d g') / (d - e). With the pencil
//   G = g e - d g',
// which vanishes for points whose plane crossing lies on g = 0, this is negative where G is.
//
//   polyhedra, boxes   Blocked where d_i <= 0 for all faces i in front of which the light is, and
//                      G_ij <= 0 for all of these and all other faces j: the ray leaves i after it
//                      has entered j. All of this is linear.
//   polygons           The same with the plane as i and the edges as j.
//   discs              d <= 0 and |a e - d a'|^2 - r^2 (d - e)^2 <= 0 with the coordinates a in the
//                      disc's plane.
//   ellipsoids         In the space where they are the unit ball: the tracer's own discriminant
//                      |p - L|^2 - |p x L|^2 >= 0, for cells that are outside the ball and behind
//                      the polar plane of L, p.L < 1.
//   closed frustums    A chord ends on a cap, or it enters and leaves by the lateral surface, on
//                      either side of the light's polar plane: it meets one of the caps or the
//                      trapezoid that the polar plane cuts out. Each is a piece as above; two sides
//                      of the trapezoid are the planes that touch the frustum and hold the light.
//                      For cells that are outside of it.
//
// Rounding. Forms come with a bound on what separates them from the tracer's decision: the distance
// between a shading point and the point with its coordinates, and kFunctionClearance of all lengths
// involved, which is a million times the tracer's rounding (about 2^-50) and thousands of times its
// root, which is what roots of grazed quadrics lose.
#pragma once

#include <optional>
#include <vector>

#include "core/scene/light.h"
#include "core/scene/scene.h"
#include "core/trace/shadow_function.h"
#include "core/tree/face_planes.h"
#include "core/tree/surface_chart.h"

namespace linetree {

inline constexpr double kFunctionClearance = 0x1p-24;

// Polyhedra of more faces have no function.
inline constexpr size_t kMaxFunctionFaces = 16;

// One planar cell and one light. `clearance` is kFunctionClearance times all lengths involved (the
// cell, the light, the object, their distances from each other and from the world's origin), world
// length.
class ShadowBuilder {
 public:
  ShadowBuilder(const SurfaceChart::PlanarCell& cell, const Light& light)
      : cell_(cell), light_(light) {}

  // Whether Build wants to know that no point of the cell is in the object or within the clearance
  // of it.
  static bool MustBeOutside(const Shape& shape) {
    return std::holds_alternative<FrustumShape>(shape);
  }

  // What is known of the object all over the cell. kUnknown: `function`, which has no pieces
  // before, says where, if it has some then; its coefficients are added to `coefficients`.
  Shadowing Build(const Shape& shape, const FacePlanes& planes, double clearance,
                  std::vector<float>& coefficients, ShadowFunction& function) const;

 private:
  const SurfaceChart::PlanarCell& cell_;
  const Light& light_;
};

}  // namespace linetree
