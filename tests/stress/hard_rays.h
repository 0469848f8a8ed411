// Rays that are hard for a cache: on the sides, edges and corners of cells, on ties between face
// pairs, parallel to faces, tangent, from inside objects and from surfaces.
#pragma once

#include <vector>

#include "core/scene/camera.h"
#include "core/scene/scene.h"
#include "tests/support/random.h"

namespace linetree::stress {

// Moves x by `ulps` units in the last place.
double Nudged(double x, int ulps);
Vec3d Nudged(const Vec3d& v, test::Random& random, int most_ulps);

// A point of the object's surface, by its definition in object space.
Vec3d PointOn(const Object& object, test::Random& random);

// From outside, each towards a surface point of one of the objects, from one to a hundred of its
// sizes away.
void AddSpread(const Scene& scene, int count, test::Random& random, std::vector<Ray>& rays);

// `count` rays to points around `target`, at distances of 1e-9 to 1 times `size`, all sizes alike,
// so that cells about it are divided far.
void AddFocused(const Vec3d& target, double size, int count, test::Random& random,
                std::vector<Ray>& rays);

// Around random surface points of all objects.
void AddClusters(const Scene& scene, int clusters, int count, test::Random& random,
                 std::vector<Ray>& rays);

// Lines with dyadic coordinates in linetree charts: corners, edges and faces of 4D cells.
void AddOnLinetreeCells(const Scene& scene, int count, test::Random& random,
                        std::vector<Ray>& rays);

// Directions whose largest components are equal, or of which some are zero.
void AddTies(const Scene& scene, int count, test::Random& random, std::vector<Ray>& rays);

// Through surface points, across their normal up to a few ulps.
void AddTangents(const Scene& scene, int count, test::Random& random, std::vector<Ray>& rays);

// Starts inside the objects' boxes and on their surfaces.
void AddFromWithin(const Scene& scene, int count, test::Random& random, std::vector<Ray>& rays);

// A mixture of them all.
std::vector<Ray> HardRays(const Scene& scene, int count, test::Random& random);

}  // namespace linetree::stress
