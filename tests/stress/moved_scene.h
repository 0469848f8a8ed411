// A scene carried by an affine map, and a scene whose objects come in another order.
#pragma once

#include "core/scene/affine_map.h"
#include "core/scene/scene.h"
#include "tests/support/random.h"

namespace linetree::stress {

// A map that keeps shapes: rigid, or a uniform scale, or both.
struct Motion {
  AffineMap map;
  double scale = 1;  // of map.linear, which is `scale` times a rotation
};
Motion ScaledBy(double scale);
Motion Rigid(test::Random& random, double distance);

// With a power of two for a scale and nothing else, every number of the moved scene is the old one
// times a power of two, exactly.
Scene Moved(const Scene& scene, const Motion& motion);
Ray Moved(const Ray& ray, const Motion& motion);

// objects[i] of the result is objects[order[i]] of the scene; order is a random permutation.
Scene Permuted(const Scene& scene, test::Random& random);

}  // namespace linetree::stress
