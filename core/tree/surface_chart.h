// The 2D charts of a shape's surface: maps between patches of it and [0,1]^2, and convex hulls of
// what lies under a square of such a chart.
//
// Frames
//   world   as everywhere.
//   object  p = object_from_world * (world - center), where curved shapes are canonical (shape.h).
//   plane   of a planar patch: x = center + X ex + Y ey with two world vectors ex, ey in the plane,
//           u = (X / hX + 1) / 2, v = (Y / hY + 1) / 2; |X| <= hX, |Y| <= hY on the face.
//
// Patches
//   sphere    2k + (p_k < 0) of the largest |p_k|, the lowest k on ties; i = (k+1)%3, j = (k+2)%3,
//             u = (atan(p_i / |p_k|) / (pi/4) + 1) / 2, v likewise with p_j: an equi-angular cube
//             map. Lines of constant u or v are great circles in object space.
//   frustum   0..3 lateral, the quadrants of the angle of (p_x, p_y) from 0, pi/2, pi, 3pi/2 on;
//             u = angle within the quadrant / (pi/2), v = p_z. A cone's apex is in patch 0.
//             4 base cap, 5 top cap (closed frustums): planar, ex and ey the object's x and y axes,
//             hX = hY = the cap's radius.
//   box       one per face, in the order of faces. Face 2k and 2k+1: ex, ey are the object's axes
//             (k+1)%3 and (k+2)%3, hX = hY = 1.
//   disc      0: ex, ey the object's x and y axes, hX = hY = 1.
//   polygon, triangle
//             0: ex along the longest edge, ey = normal x ex, both unit; the rectangle that bounds
//             the vertices, widened by kRectangleMargin.
//   polyhedron
//             one per face, in the order of faces; as for polygons, with the vertices that lie on
//             the face.
// (u, v) are not turned the same way on all patches: charts say where, not which side is out.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/scene/scene.h"

namespace linetree {

inline constexpr int kMaxSurfaceDepth = 20;

// The square [i, i+1] x [j, j+1] * 2^-depth of a patch; depth <= kMaxSurfaceDepth.
struct SurfaceCell {
  uint8_t depth = 0;
  uint32_t i = 0, j = 0;

  bool operator==(const SurfaceCell&) const = default;
  // Bit 0 of `child`: upper half in u; bit 1: in v.
  SurfaceCell Child(int child) const {
    return {static_cast<uint8_t>(depth + 1), 2 * i + (static_cast<uint32_t>(child) & 1),
            2 * j + (static_cast<uint32_t>(child) >> 1 & 1)};
  }
  // Which child of its ancestor at depth `level` leads here; level < depth.
  int ChildAt(int level) const {
    const int shift = depth - level - 1;
    return static_cast<int>((i >> shift & 1) | (j >> shift & 1) << 1);
  }
};

// u, v in [0, 1].
struct SurfacePoint {
  int patch = 0;
  double u = 0, v = 0;
};

// The cell of the given depth that holds the point; upper sides of the patch belong to the last.
SurfaceCell CellAt(const SurfacePoint& point, int depth);

// Its convex hull contains the piece of surface under a cell. World.
struct PatchHull {
  std::array<Vec3d, 8> points;
};

// Slack of a chart, relative to the object's size plus its distance from the world's origin: eight
// million roundings of the coordinates, so that hits of rays from 2^17 such lengths away are within
// it (most shapes: a test), and a billionth of the length. Nothing rests on its size: see IsOn.
inline constexpr double kSurfaceSlack = 0x1p-30;

// By how much the rectangles of polygons and polyhedron faces are widened, relative to the same
// length: a corner of angle a reaches 2^-50 / sin(a) beyond its vertex by rounding, and polyhedron
// vertices are off by as much. It serves corners down to 2^-24 rad.
inline constexpr double kRectangleMargin = 0x1p-24;

// Immutable; any number of threads may use it.
class SurfaceChart {
 public:
  // Keeps nothing of the object.
  explicit SurfaceChart(const Object& object);

  int patches() const { return curved_patches_ + static_cast<int>(planes_.size()); }

  // Coordinates of a hit on `face` (numbered as in shape.h) at a world point. Total: points off
  // the surface, by rounding, get coordinates too, clamped into [0, 1].
  SurfacePoint Locate(int face, const Vec3d& point) const;

  // Whether the point is certainly within half of Slack() of a surface point with the same
  // coordinates. Hits of rays from very far, near a cone's apex or at the tip of a needle may not
  // be; nothing that a hull promises holds for them.
  bool IsOn(int face, const Vec3d& point) const;

  // How points of one face are located and tested, as numbers: Locate and IsOn for those who handle
  // many points at a time. With d = point - center:
  //   kPlane    u = (row[0].d + 1) / 2, v = (row[1].d + 1) / 2, both in [0, 1]; on the face where
  //             |row[2].d| <= tolerance (world length), row[2] the unit normal of PlanarCellOf.
  //   kSphere, kLateral   p = (row[0].d, row[1].d, row[2].d) is in object space; on the face where
  //             p is as far from the surface as the tolerance (object length) at most.
  // Coordinates may differ from Locate's by rounding; hulls have room for that.
  struct FaceForm {
    enum class Kind : uint8_t { kPlane, kSphere, kLateral };
    Kind kind = Kind::kPlane;
    int patch = 0;  // of a plane; the first one of a curved face
    Vec3d center;
    std::array<Vec3d, 3> row;
    double tolerance = 0;
    double base_radius = 1, taper = 0;  // kLateral
  };
  FaceForm FormOf(int face) const;

  // conv(points) contains every x on the surface whose Locate falls into the cell, up to rounding
  // of Locate at the cell's sides, and every point within Slack() of such an x.
  PatchHull HullOf(int patch, const SurfaceCell& cell) const;

  // The cell of a planar patch: the points corner + s eu + t ev, s and t in [0, 1]. Nothing for
  // curved patches.
  struct PlanarCell {
    Vec3d corner, eu, ev;
    Vec3d normal;  // unit; outwards on solids and frustums
    // World length: every point that is on the surface (IsOn) and in the cell is this close to
    // the point with the same s and t.
    double pad;
  };
  std::optional<PlanarCell> PlanarCellOf(int patch, const SurfaceCell& cell) const;

  // Whether the outside of a solid or frustum faces away from the light all over the hull of a cell
  // of the patch: on flat patches for every hit that is on the surface (IsOn), on curved ones up to
  // rounding. Never for planar shapes, which have two outsides.
  bool FacesAway(int patch, const PatchHull& hull, const Light& light) const;

  // Whether a facing normal belongs to the side of a planar shape that its own normal does not
  // point to. Solids and frustums are seen from outside.
  bool IsOtherSide(const Vec3d& facing) const {
    return is_thin_ && Dot(facing, planes_[0].normal) < 0;
  }

  // Whether the shape lies in one plane and has two outer sides.
  bool IsThin() const { return is_thin_; }

  uint64_t HeapBytes() const { return planes_.capacity() * sizeof(PlanePatch); }

  // World length.
  double Slack() const { return slack_; }

 private:
  enum class Curved { kNone, kSphere, kLateral };

  // A parallelogram in a plane.
  struct PlanePatch {
    Vec3d center;
    Vec3d ex, ey;
    Vec3d gx, gy;  // dual to ex, ey in the plane: X = gx.(x - center)
    Vec3d normal;  // unit; outwards unless the whole shape is planar
    double hx = 1, hy = 1;
    double pad = 0;  // PlanarCell::pad
  };
  struct Builder;

  static PlanePatch MakePlane(const Vec3d& center, const Vec3d& ex, const Vec3d& ey, double half);
  // The side of a solid that has `inside` behind it.
  static PlanePatch MakeSide(const Vec3d& inside, const Vec3d& center, const Vec3d& ex,
                             const Vec3d& ey, double half);
  static PlanePatch MakeRectangle(const Plane& plane, const Vec3d& along,
                                  const std::vector<Vec3d>& vertices, double margin);
  // Takes over a curved shape's frame and the bound on rounding that goes with it.
  void SetFrame(Curved curved, const AffineFrame& frame);

  SurfacePoint LocateOnSphere(const Vec3d& point) const;
  SurfacePoint LocateOnLateral(const Vec3d& point) const;
  double PadOf(const PlanePatch& plane) const;
  PatchHull PlaneHull(const PlanePatch& plane, const SurfaceCell& cell) const;
  PatchHull SphereHull(int patch, const SurfaceCell& cell) const;
  PatchHull LateralHull(int patch, const SurfaceCell& cell) const;
  Vec3d ToWorld(const Vec3d& p) const;
  // By how much a plane in object space with this normal (any length) has to move outwards, times
  // the normal's length, to be moved by pad_ in the world.
  double Shift(const Vec3d& normal) const;

  bool is_thin_;  // lies in one plane
  double reach_;  // the object's size plus its distance from the origin
  double slack_;
  double max_stretch_ = 1;  // of a curved frame: at least world length per object length
  double pad_;  // what curved hulls are widened by: the slack and a bound on all rounding
  Curved curved_ = Curved::kNone;
  int curved_patches_ = 0;
  AffineFrame frame_;                   // of a curved shape
  double base_radius_ = 1, taper_ = 0;  // w(z) = base_radius_ + taper_ z
  std::vector<PlanePatch> planes_;
};

}  // namespace linetree
