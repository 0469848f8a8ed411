// Which lights a sum over a curved cell could hold at all: a plain look at five points, before jets
// are asked for bounds, which cost a hundred times as much.
#pragma once

#include <array>
#include <vector>

#include "core/scene/scene.h"
#include "core/tree/surface_chart.h"

namespace linetree {

// Where the bilinear interpolant of a light's diffuse term errs at a point by more than `spread` of
// the term's least value over some points, no bound on the error can be less than that share of a
// bound on the least value. So what MayBeLinear refuses, jets would refuse as well; what it lets
// pass they have to look at.
class CurvedScreen {
 public:
  // A cell of a sphere or of a frustum's lateral surface.
  CurvedScreen(const Shape& shape, int patch, const SurfaceCell& cell);
  // A cell of a triangle with vertex normals, turned by 1 or -1.
  CurvedScreen(const TriangleShape& shape, const SurfaceChart::PlanarCell& cell, double turn);

  // Whether the cell touches a cone's apex, where there is no normal: neither has a smaller one.
  bool HasApex() const { return has_apex_; }
  bool MayBeLinear(const Light& light, double spread) const;

 private:
  static constexpr size_t kPlaces = 5;  // the corners and the middle

  void SetSphere(const SphereShape& shape, int patch, const SurfaceCell& cell);
  void SetLateral(const FrustumShape& shape, int patch, const SurfaceCell& cell);
  void Set(size_t place, const AffineFrame& frame, const Vec3d& point, const Vec3d& gradient);

  bool has_apex_ = false;
  // World; the normals are unit vectors.
  std::array<Vec3d, kPlaces> points_, normals_;
};

}  // namespace linetree
