// The diffuse light of one light after the other on a cell of a curved surface, with bounds, from
// corner jets of dimension 2: curved_cell-inl.h.
#pragma once

#include <array>
#include <span>

#include "core/certify/jet_shape.h"
#include "core/scene/scene.h"
#include "core/tree/surface_chart.h"

namespace linetree {

// max(0, n.l) over a cell, times what the distance leaves of the light.
struct CurvedTerm {
  bool is_known = false;
  double error = 0;  // of bilinear interpolation between the corners
  double least = 0, most = 0;
  std::array<double, 4> corners{};
};

// A cell of a sphere, of a frustum's lateral surface or of a triangle with vertex normals, and the
// lights that are asked for.
struct CurvedTask {
  const Scene& scene;
  const JetShape& shape;
  int patch;
  const SurfaceCell& cell;
  // World length: hits are this close to the surface point with the same coordinates, and half as
  // far from a curved surface.
  double slip;
  std::span<const size_t> lights;
  // Of a triangle: its cell, and 1 or -1, by which its own shading normal is turned.
  const SurfaceChart::PlanarCell* plane = nullptr;
  double turn = 1;
};

// One term for every light; false: the surface does not have a normal everywhere on the cell. Both
// say the same, bit by bit; the one without SIMD is the plain twin.
bool FindCurvedTermsScalar(const CurvedTask& task, CurvedTerm* terms);
bool FindCurvedTermsSimd(const CurvedTask& task, CurvedTerm* terms);

}  // namespace linetree
