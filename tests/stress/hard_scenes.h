// Scenes at the edges of what a scene may be. Deterministic in the random numbers given.
#pragma once

#include <ostream>
#include <vector>

#include "core/scene/scene.h"
#include "tests/support/random.h"

namespace linetree::stress {

// Sizes of objects log-uniform over [1e-6, 1e6], each among smaller and larger ones.
Scene AllScales(test::Random& random);

// Objects of all shapes, of about unit size, 1e6 away from the origin.
Scene FarAway(test::Random& random);

// Balls that rest on a floor, stacked boxes, spheres inscribed in boxes, cones on their apex.
Scene Touching(test::Random& random);

// Objects twice in the same place, with different materials; discs within planes.
Scene Coincident(test::Random& random);

// Glass in glass in glass, concentric and tangent from inside.
Scene Nested(test::Random& random);

// Lights in surfaces, at corners, at centres, and in the planes of polygons.
Scene LightsOnSurfaces(test::Random& random);

// Directional lights along faces, up to a few ulps.
Scene AtTheTerminator(test::Random& random);

// Exponents 1 to 1000, with lights at the rays' own origins.
Scene Highlights(test::Random& random);

// Solids of many indices.
Scene Prisms(test::Random& random);

// Coefficients, lights and backgrounds that are denormal or zero, and a tiny white.
Scene Denormal(test::Random& random);

// A hundred small objects in front of two lights: long lists, with a hierarchy.
Scene Crowded(test::Random& random);

struct NamedScene {
  const char* name;
  Scene (*make)(test::Random& random);
};
// How GoogleTest shows it.
inline void PrintTo(const NamedScene& scene, std::ostream* out) { *out << scene.name; }
const std::vector<NamedScene>& AllHardScenes();

}  // namespace linetree::stress
