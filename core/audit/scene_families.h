// Random scenes for audits, in families that are each hard on one kind of certificate. All shapes,
// materials and lights of the scene format occur.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "core/scene/scene.h"

namespace linetree {

enum class SceneFamily {
  kGeneric,     // everything at random, in each other's way
  kMirrors,     // large mirrors that see small clutter
  kNearLights,  // lights 0.05 to 0.6 from glossy surfaces, exponents 40 to 160
  kGlass,       // indices from 1.05 to 2, solids within and behind each other
  kBlack,       // no ambient light and no background: what no light reaches is black
  kWalls,       // rooms of abutting boxes and polygons, some of them mirrors, on a dyadic grid
  kTubes,       // open cylinders and cones, lit from within and without
};
inline constexpr int kSceneFamilies = 7;
inline constexpr std::array<std::string_view, kSceneFamilies> kSceneFamilyNames = {
    "generic", "mirrors", "near-lights", "glass", "black", "walls", "tubes"};

inline std::string_view NameOf(SceneFamily family) {
  return kSceneFamilyNames[static_cast<size_t>(family)];
}
std::optional<SceneFamily> FamilyOfName(std::string_view name);

// A pure function of its arguments (for one compiler: C++ leaves the order of random draws within
// an expression open). The scene has three cameras that see something of it; its name is "FAMILY
// SEED", its version is empty. One scene in four is large, small or far from the origin.
std::shared_ptr<const Scene> MakeFamilyScene(SceneFamily family, uint64_t seed);

}  // namespace linetree
