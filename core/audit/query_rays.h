// Rays to ask a scene for: at random, where certificates end, and near a given ray.
//
// Thread safety: all methods are const and take the random numbers from the caller.
#pragma once

#include <vector>

#include "core/audit/random_stream.h"
#include "core/trace/tracer.h"
#include "core/tree/ray_space.h"
#include "core/tree/surface_chart.h"

namespace linetree {

class QueryRays {
 public:
  // Keeps a reference to the tracer. `views`: valid cameras, one at least.
  QueryRays(const Tracer& tracer, std::vector<Camera> views);

  // Mostly what the views see; the rest from anywhere around the objects, and from points on them.
  Ray Random(RandomStream& random) const;

  // On dyadic positions, along axes, at corners of cells of both kinds of tree, at edges of
  // objects, and where the shadow of an edge falls.
  Ray Lattice(RandomStream& random) const;

  // A ray close by: its origin or target, or both, moved by `step` times the scene's size (the
  // target by no more than `step` times its distance).
  Ray Near(const Ray& ray, double step, RandomStream& random) const;

 private:
  Vec3d Eye(RandomStream& random) const;
  size_t AnyObject(RandomStream& random) const;
  // A corner, or a dyadic point on an edge or rim, of the object.
  Vec3d Feature(size_t object, RandomStream& random) const;
  Ray Towards(const Vec3d& origin, const Vec3d& target, RandomStream& random) const;
  Ray FromSurface(RandomStream& random) const;
  Ray AlongLinetreeCorner(RandomStream& random) const;
  Ray AtSurfaceCorner(RandomStream& random) const;
  Ray AlongAxis(RandomStream& random) const;
  Ray AtShadowEdge(RandomStream& random) const;

  const Tracer& tracer_;
  const Scene& scene_;
  const std::vector<Camera> views_;
  std::vector<EyeRays> eye_rays_;  // of the unit square
  std::vector<ObjectChart> charts_;
  std::vector<SurfaceChart> surfaces_;
  Box3 around_;  // the objects, and half as much on each side
  double size_;
};

}  // namespace linetree
