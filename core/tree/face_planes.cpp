#include "core/tree/face_planes.h"

namespace linetree {
namespace {

struct Lister {
  FacePlanes& planes;

  // sign * row.(x - center) = value, a plane in object space.
  void Add(const AffineFrame& frame, size_t axis, double sign, double value) {
    const Vec3d& row = frame.object_from_world.row[axis];
    const double length = Length(row);
    const Vec3d normal = row * (sign / length);
    planes.faces.push_back({normal, frame.center + normal * (value / length)});
  }

  void operator()(const SphereShape& /*s*/) {}
  void operator()(const BoxShape& s) {
    for (size_t axis = 0; axis < 3; ++axis) {
      Add(s.frame, axis, -1, 1);
      Add(s.frame, axis, 1, 1);
    }
  }
  void operator()(const FrustumShape& s) {
    Add(s.frame, 2, -1, 0);
    Add(s.frame, 2, 1, 1);
  }
  void operator()(const DiscShape& s) { planes.faces.push_back(s.plane); }
  void operator()(const PolygonShape& s) {
    planes.faces.push_back(s.plane);
    planes.edges = s.edges;
  }
  void operator()(const TriangleShape& s) { (*this)(s.polygon); }
  void operator()(const PolyhedronShape& s) { planes.faces = s.faces; }
};

}  // namespace

FacePlanes FacePlanesOf(const Shape& shape) {
  FacePlanes planes;
  planes.is_planar = IsPlanar(shape);
  std::visit(Lister{planes}, shape);
  return planes;
}

}  // namespace linetree
