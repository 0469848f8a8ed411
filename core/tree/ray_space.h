// Ray space: coordinates for the lines that meet one object (paper section 6, figures 7 and 8).
//
// Frames
//   world   as everywhere.
//   chart   orthonormal axes e0, e1, e2 fixed to the object; y = (e0.(x-c), e1.(x-c), e2.(x-c)).
//           World axes for spheres and polyhedra, the shape's own for boxes and frustums; for
//           planar shapes e2 is the plane's normal and c lies in the plane.
//
// Face pairs. A ray of direction d belongs to the pair p = 2k + (d_k < 0) of its largest chart
// component |d_k|, the lowest k on ties. With i = (k+1)%3, j = (k+2)%3:
//
//   solids and open frustums (two planes). h is the half extent of the object's box in the chart.
//     The ray crosses the entry plane y_k = -s h_k and the exit plane y_k = s h_k, s = sign(d_k).
//       a = (y_i / H_i + 1) / 2, b = (y_j / H_j + 1) / 2 on entry; c, d likewise on exit,
//     with expanded half sizes H_i = h_i + 2 h_k. A ray that meets the box does so at some |y_i| <=
//     h_i, and from there to either plane y_k changes by at most 2 h_k and y_i, because |d_i| <=
//     |d_k|, by no more: |y_i| <= H_i on both planes, so every ray has coordinates in [0,1]^4. The
//     bound is attained.
//
//   planar shapes (the first plane is the surface itself). The ray crosses the plane at y_2 = 0:
//       a = (y_0 / h_0 + 1) / 2, b = (y_1 / h_1 + 1) / 2,
//       c = (d_i / |d_k| + 1) / 2, d = (d_j / |d_k| + 1) / 2; the pair holds the sign of d_k.
//     Slopes lie in [-1, 1] by the choice of k, and the crossing lies in the shape's rectangle
//     whenever the ray meets the shape. The rectangle is inset by kRimInset of its longer side, so
//     that the corners of cells at the rim, which lie on its border, meet the shape in spite of
//     rounding; what hits outside takes the coordinates of the border. Rays parallel to the plane
//     have no coordinates.
//
// Accuracy: LineOf(CoordsOf(ray)) is the ray's line up to rounding: at the object its points move
// by at most kLineRounding times the largest of the expanded half sizes plus |c - origin|.
#pragma once

#include <array>
#include <optional>

#include "core/scene/scene.h"
#include "core/tree/cell.h"

namespace linetree {

inline constexpr int kFacePairs = 6;

// Far above the rounding of a hit point within a thousand sizes of the origin, far below what
// a radiance in float can show.
inline constexpr double kRimInset = 0x1p-40;

// See "Accuracy" above: eight roundings of 2^-53, one for every operation in the longest chain
// between a ray and its reconstruction (to the chart, to the plane, scaled, and back).
inline constexpr double kLineRounding = 0x1p-50;

// The lines of a pair as polynomials in their coordinates: line(x) = origin + sum x_i origin_by[i]
// + t (direction + sum x_i direction_by[i]).
struct LineForm {
  Vec3d origin, direction;
  std::array<Vec3d, 4> origin_by, direction_by;
  // Whether directions reach from the entry plane (t = 0) to the exit plane (t = 1); otherwise the
  // object lies in a plane and t = 0 is on it.
  bool between_planes = false;
  // The part of every direction along the pair's axis, which is the same for all.
  double along_axis = 1;
};

class ObjectChart {
 public:
  explicit ObjectChart(const Object& object);

  // The face pair of a direction (any non-zero length), in [0, kFacePairs).
  int PairOf(const Vec3d& direction) const;

  // Coordinates of a line in the pair of its direction. Empty when the line is parallel to a planar
  // object or passes its box by more than rounding.
  std::optional<RayCoords> CoordsOf(int pair, const Vec3d& origin, const Vec3d& direction) const;

  // The line with these coordinates, through the entry plane (or the planar object's own plane),
  // with unit direction.
  Ray LineOf(int pair, const RayCoords& coords) const;

  // The same lines, with directions that are not of unit length.
  LineForm FormOf(int pair) const;

 private:
  Vec3d ToChart(const Vec3d& v) const { return {Dot(v, e_[0]), Dot(v, e_[1]), Dot(v, e_[2])}; }
  Vec3d ToWorld(const Vec3d& y) const { return e_[0] * y.x + e_[1] * y.y + e_[2] * y.z; }

  Vec3d center_;
  std::array<Vec3d, 3> e_;
  Vec3d half_;
  bool planar_;
};

}  // namespace linetree
