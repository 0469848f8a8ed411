// What point lights throw on the nodes of a planar cell: the part of a diffuse sum that costs most.
#pragma once

#include <array>
#include <span>

#include "core/math/rgb.h"
#include "core/math/vec3.h"

namespace linetree {

inline constexpr size_t kPlaneNodes = 16;

// World, one coordinate or channel after the other.
struct NodePlaces {
  std::array<double, kPlaneNodes> x, y, z;
};
struct NodeSums {
  std::array<double, kPlaneNodes> r{}, g{}, b{};
};

struct NodeLight {
  Vec3d position;
  Rgb strength;  // irradiance times the light's height above the plane
};

// Adds strength / |position - place| of all lights to the sums, in their order. No light lies on a
// place. With the best vectors of this machine, and one number after the other: both give the same
// bits.
void AddPointLights(const NodePlaces& places, std::span<const NodeLight> lights, NodeSums& sums);
void AddPointLightsScalar(const NodePlaces& places, std::span<const NodeLight> lights,
                          NodeSums& sums);

}  // namespace linetree
