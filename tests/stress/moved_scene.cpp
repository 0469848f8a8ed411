#include "tests/stress/moved_scene.h"

#include <numeric>
#include <utility>
#include <variant>

namespace linetree::stress {
namespace {

Mat3 Times(const Mat3& m, double k) { return {{m.row[0] * k, m.row[1] * k, m.row[2] * k}}; }

// Moves one shape in place.
struct Mover {
  const Motion& motion;

  Vec3d Point(const Vec3d& p) const { return Apply(motion.map, p); }
  Vec3d Normal(const Vec3d& n) const { return motion.map.linear * n * (1 / motion.scale); }
  void Move(Plane& plane) const { plane = {Normal(plane.normal), Point(plane.point)}; }
  void Move(AffineFrame& frame) const {
    frame.center = Point(frame.center);
    frame.world_from_object = Product(motion.map.linear, frame.world_from_object);
    // The inverse of scale * R is R^T / scale, and R is linear / scale.
    const Mat3 inverse = Times(Transposed(motion.map.linear), 1 / motion.scale / motion.scale);
    frame.object_from_world = Product(frame.object_from_world, inverse);
  }

  void operator()(SphereShape& s) const { Move(s.frame); }
  void operator()(BoxShape& s) const { Move(s.frame); }
  void operator()(FrustumShape& s) const { Move(s.frame); }
  void operator()(DiscShape& s) const {
    Move(s.frame);
    Move(s.plane);
  }
  void operator()(PolygonShape& s) const {
    for (Vec3d& v : s.vertices) v = Point(v);
    Move(s.plane);
    for (Plane& edge : s.edges) Move(edge);
  }
  void operator()(TriangleShape& s) const {
    (*this)(s.polygon);
    for (Vec3d& n : s.normals) n = Normal(n);
  }
  void operator()(PolyhedronShape& s) const {
    for (Plane& face : s.faces) Move(face);
    for (Vec3d& v : s.vertices) v = Point(v);
  }
};

}  // namespace

Motion ScaledBy(double scale) { return {Scaling({scale, scale, scale}), scale}; }

Motion Rigid(test::Random& random, double distance) {
  const AffineMap turn = Rotation(random.Direction(), random.Uniform(0, 360));
  return {Then(turn, Translation(random.Direction() * distance)), 1};
}

Scene Moved(const Scene& scene, const Motion& motion) {
  const Mover mover{motion};
  Scene moved = scene;
  for (Object& object : moved.objects) {
    std::visit(mover, object.shape);
    object.bounds = Bounds(object.shape);
  }
  for (Light& light : moved.lights) {
    light.position = mover.Point(light.position);
    light.to_light = mover.Normal(light.to_light);
    light.fade_distance *= motion.scale;
  }
  return moved;
}

Ray Moved(const Ray& ray, const Motion& motion) {
  return {Apply(motion.map, ray.origin), Mover{motion}.Normal(ray.direction)};
}

Scene Permuted(const Scene& scene, test::Random& random) {
  Scene permuted = scene;
  for (int i = static_cast<int>(permuted.objects.size()) - 1; i > 0; --i) {
    std::swap(permuted.objects[static_cast<size_t>(i)],
              permuted.objects[static_cast<size_t>(random.Int(0, i))]);
  }
  return permuted;
}

}  // namespace linetree::stress
