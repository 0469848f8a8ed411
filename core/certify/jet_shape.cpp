#include "core/certify/jet_shape.h"

#include <algorithm>
#include <cmath>

namespace linetree {
namespace {

// The radius of a sphere with this frame; 0 for other ellipsoids.
double RadiusOf(const AffineFrame& frame) {
  const Mat3& m = frame.object_from_world;
  const double square = LengthSquared(m.row[0]);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double expected = i == j ? square : 0;
      const double product = Dot(m.row[static_cast<size_t>(i)], m.row[static_cast<size_t>(j)]);
      if (std::abs(product - expected) > kSimilarity * square) return 0;
    }
  }
  return 1 / std::sqrt(square);
}

// JetShape::slant.
double SlantOf(const FrustumShape& s) {
  const Mat3& m = s.frame.object_from_world;
  const double across = LengthSquared(m.row[0]), along = LengthSquared(m.row[2]);
  const auto is_near = [&](double x, double square) { return std::abs(x) <= kSimilarity * square; };
  const bool keeps = is_near(LengthSquared(m.row[1]) - across, across) &&
                     is_near(Dot(m.row[0], m.row[1]), across) &&
                     is_near(Dot(m.row[0], m.row[2]), std::sqrt(across * along)) &&
                     is_near(Dot(m.row[1], m.row[2]), std::sqrt(across * along));
  const double taper = s.top_radius - s.base_radius;
  return keeps ? std::sqrt(across + along * taper * taper) : 0;
}

// The plane where object coordinate `axis` is `value`, outwards to the side `sign`.
Plane FramePlane(const AffineFrame& frame, int axis, double value, double sign) {
  Vec3d p;
  p[axis] = value;
  const Vec3d& gradient = frame.object_from_world.row[static_cast<size_t>(axis)];
  return {Normalized(gradient) * sign, frame.center + frame.world_from_object * p};
}

struct Maker {
  JetShape shape;

  void operator()(const SphereShape& s) {
    shape.kind = JetShape::Kind::kSphere;
    shape.frame = s.frame;
    shape.radius = RadiusOf(s.frame);
  }
  void operator()(const BoxShape& s) {
    for (int axis = 0; axis < 3; ++axis) {
      shape.planes.push_back(FramePlane(s.frame, axis, -1, -1));
      shape.planes.push_back(FramePlane(s.frame, axis, 1, 1));
    }
  }
  void operator()(const FrustumShape& s) {
    shape.kind = JetShape::Kind::kFrustum;
    shape.frame = s.frame;
    shape.base_radius = s.base_radius;
    shape.taper = s.top_radius - s.base_radius;
    shape.open = s.open;
    shape.slant = SlantOf(s);
    shape.planes = {FramePlane(s.frame, 2, 0, -1), FramePlane(s.frame, 2, 1, 1)};
  }
  void operator()(const DiscShape& s) {
    shape.kind = JetShape::Kind::kDisc;
    shape.frame = s.frame;
    shape.planes = {s.plane};
  }
  void operator()(const PolygonShape& s) {
    shape.kind = JetShape::Kind::kPolygon;
    shape.planes = {s.plane};
    shape.edges = s.edges;
  }
  void operator()(const TriangleShape& s) {
    (*this)(s.polygon);
    shape.corner_normals.assign(s.normals.begin(), s.normals.end());
    for (size_t i = 0; i < 3; ++i) {
      shape.heights.push_back(SignedDistance(s.polygon.edges[(i + 1) % 3], s.polygon.vertices[i]));
    }
  }
  void operator()(const PolyhedronShape& s) { shape.planes = s.faces; }
};

}  // namespace

const Plane* JetShape::PlaneOf(int face) const {
  switch (kind) {
    case Kind::kSphere:
      return nullptr;
    case Kind::kFrustum:
      return face == 0 ? nullptr : &planes[static_cast<size_t>(face - 1)];
    case Kind::kPlanes:
      return &planes[static_cast<size_t>(face)];
    case Kind::kPolygon:
    case Kind::kDisc:
      return &planes[0];
  }
  return nullptr;
}

JetShape MakeJetShape(const Object& object) {
  Maker maker;
  std::visit([&](const auto& s) { maker(s); }, object.shape);
  JetShape& shape = maker.shape;
  for (int i = 0; i < 3; ++i) {
    shape.reach =
        std::max({shape.reach, std::abs(object.bounds.min[i]), std::abs(object.bounds.max[i])});
  }
  shape.reach += Length(object.bounds.Extent());
  for (const Vec3d& row : shape.frame.object_from_world.row) {
    shape.frame_rows =
        std::max(shape.frame_rows, std::abs(row.x) + std::abs(row.y) + std::abs(row.z));
  }
  return shape;
}

}  // namespace linetree
