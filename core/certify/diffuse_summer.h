// Sums of the diffuse light of many lights over cells of surface, with proved bounds on the error.
//
// Planar cells: on a plane n.(L - x) is a constant h, and E h / |L - x| is interpolated bicubically
// at 4 x 4 nodes. Along any line |d^4/ds^4 (1/r)| = 4! |P_4(cos)| / r^5 <= 24 / r^5 (Legendre's
// polynomial), and cubic interpolation over a length w errs by at most max|f''''| / 24 * (w/3)^4,
// so
//   error <= sum_l E_l h_l (wu^4 + Lambda wv^4) / (81 dmin_l^5),
// Lambda = 1.64 bounding the sum of the absolute weights of four equidistant nodes, which pass the
// error along the one axis on to the other. For lamps that fade with distance: fading.h.
//
// Spheres, frustums and triangles with vertex normals: bilinear, with the bound of corner jets of
// dimension 2 (curved_cell-inl.h). The tracer turns a triangle's interpolated normal against the
// ray and asks nothing else, so that its two sides are those of the plane as long as all three
// vertex normals are on the same side of it; others are left alone.
#pragma once

#include <optional>
#include <vector>

#include "core/certify/plane_nodes.h"
#include "core/tree/light_certifier.h"
#include "core/tree/surface_chart.h"

namespace linetree {

// One light is enough: a tile of pixels on a flat face (see the frame path) needs nothing but the
// sum then.
inline constexpr int kMinSummedLights = 1;

// Rounding of a sum's answer, relative to its largest node. Nodes are floats, at most 1.64^2 of
// whose largest rounding reaches the sum; so does that of the weights and products when the sum is
// evaluated in float (12 of 2^-24), where the two coordinates are off by 2^-24 of the cell, along
// each of which the polynomial changes by at most 9 times its largest node: 33 of 2^-24, rounded up
// to 64. In double, of which only the first part is seen, no more than a 24th of it is used. Nodes
// of planar cells are off by kInverseRootRounding before they are rounded: a thousandth of 2^-24.
inline constexpr double kNodeRounding = 0x1p-18;

struct CurvedTask;

class DiffuseSummer {
 public:
  enum class Lanes { kSimd, kScalar };

  // Keeps a reference to the scene, which must outlive it. Without SIMD, the plain twin, sums are
  // the same, bit by bit.
  explicit DiffuseSummer(const Scene& scene, Lanes lanes = Lanes::kSimd)
      : scene_(scene), lanes_(lanes) {}

  const Scene& scene() const { return scene_; }

  // Adds to a cell's lights, as they are certified, the sums that are worth it, and marks what is
  // in them.
  void AddSums(int object, const SurfaceChart& chart, int patch, const SurfaceCell& cell,
               CellLights& lights) const;

 private:
  using MaybeSum = std::unique_ptr<const DiffuseSum>;

  // On the side that `normal` points to. Both take those lights out of `lights` that are not in the
  // sum and may face the side.
  MaybeSum SumOnPlane(const SurfaceChart::PlanarCell& cell, const Vec3d& normal,
                      std::vector<size_t>& lights) const;
  MaybeSum SumOnCurve(const Object& receiver, double slip, int patch, const SurfaceCell& cell,
                      std::vector<size_t>& lights) const;
  // The same for a triangle with vertex normals, which `turn` (1 or -1) turns to the side.
  MaybeSum SumOnSmooth(const Object& receiver, const SurfaceChart::PlanarCell& plane, double turn,
                       std::vector<size_t>& lights) const;
  MaybeSum SumOfTerms(const CurvedTask& task, std::vector<size_t>& lights) const;

  const Scene& scene_;
  const Lanes lanes_;
};

}  // namespace linetree
