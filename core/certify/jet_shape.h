// Shapes in the form in which bundles of rays meet them: planes in world space, and at most one
// quadric in an object frame.
#pragma once

#include <vector>

#include "core/scene/scene.h"

namespace linetree {

// A frame is taken for a similarity when its axes differ by less than this from one length and
// from right angles; what that leaves of an error is far inside every margin.
inline constexpr double kSimilarity = 0x1p-46;

struct JetShape {
  enum class Kind {
    kSphere,   // |p| = 1
    kFrustum,  // x^2 + y^2 = w(z)^2, 0 <= z <= 1, between two planes
    kPlanes,   // boxes and polyhedra: one plane for every face, normals outwards
    kPolygon,  // one plane, and edges
    kDisc,     // one plane, and x^2 + y^2 <= 1
  };

  Kind kind = Kind::kPlanes;
  AffineFrame frame;  // kSphere, kFrustum, kDisc
  double base_radius = 1, taper = 0;
  bool open = false;
  std::vector<Plane> planes;  // kFrustum: base, top; kPolygon, kDisc: the surface
  std::vector<Plane> edges;   // kPolygon
  // Shading normals at the vertices of a kPolygon with three, weighted by the distances from the
  // opposite edges in units of the heights; empty for flat ones.
  std::vector<Vec3d> corner_normals;
  std::vector<double> heights;
  // kSphere: the radius if the frame only scales and turns, or else 0.
  double radius = 0;
  // kFrustum, if the frame keeps right angles and circles: the length of the surface's gradient,
  // halved and in the world, per w; otherwise 0. At hits x^2 + y^2 = w^2, so that it is
  // sqrt(a^2 (x^2 + y^2) + b^2 (w taper)^2) = w sqrt(a^2 + b^2 taper^2), a and b the frame's
  // scales.
  double slant = 0;
  // Largest coordinate of the object's bounds plus its size: what margins are relative to.
  double reach = 0;

  // The plane of a face, or null for the curved face.
  const Plane* PlaneOf(int face) const;
  // Largest sum of absolute entries of a row of object_from_world: frame units per world length.
  double frame_rows = 0;

  // How accurately points of the object are known in its own frame's units, but for the rounding of
  // rays that come from farther away than the world's origin: a multiple of 2^-53.
  double FrameScale() const { return 1 + frame_rows * reach; }
  bool IsThin() const { return kind == Kind::kPolygon || kind == Kind::kDisc; }
};

// Near a cone's apex rounding turns the normal: no nearer than this share of FrameScale.
inline constexpr double kApexShare = 0x1p-20;

JetShape MakeJetShape(const Object& object);

}  // namespace linetree
