// Point lights over a planar cell, many at a time: which of them its diffuse sum takes, with bounds
// on their terms (diffuse_summer.h has the derivation), and what they throw on its nodes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/math/rgb.h"
#include "core/math/vec3.h"
#include "core/scene/light.h"

namespace linetree {

inline constexpr size_t kPlaneNodes = 16;

// World, one coordinate or channel after the other.
struct NodePlaces {
  std::array<double, kPlaneNodes> x, y, z;
};
struct NodeSums {
  std::array<double, kPlaneNodes> r{}, g{}, b{};
};

// Distances are trusted to this, relative to their own size and the cell's.
inline constexpr double kLengthMargin = 0x1p-30;

// A light whose own term may be off by a larger share is left out and evaluated exactly: mostly one
// that is near. What is left in a sum is off by no more.
inline constexpr double kMaxTermSpread = 1.0 / 64;

// Of the height of a light above a plane, relative to the coordinates it comes from: 6 u for the
// cell's middle, 1 for the segment, 3 for the product, and as many once more for the tracer's own,
// whose unit normal has 2.5; together 23 u, and 32 are allowed for. No sum shows them: lights are
// taken from a height of kLengthMargin on, where this is 2^-18, as much as kNodeRounding, and
// nearly all of that is allowance for sums in float.
inline constexpr double kHeightRounding = 0x1p-48;

// Lights nearer or farther are left out: squares of what is in between are ordinary numbers, which
// InverseRoot asks for.
inline constexpr double kLeastReach = 0x1p-400, kMostReach = 0x1p400;

// A cell of a plane, as lights in front of it see it.
struct PlaneView {
  Vec3d normal, center;
  double radius;   // of the cell about its middle
  double reach;    // of its points from the world's origin, as the sum of the coordinates' sizes
  double slip;     // what a hit's place does to the height of a light and to how far away it is
  double stretch;  // (wu^4 + Lambda wv^4) / (24 * 81): the error for each of |f''''|
};

// The distances of a light that does not fade from all points of a cell, and its height above it.
struct LightReach {
  enum class Side { kFront, kBehind, kUnknown };
  Side side = Side::kUnknown;
  double height = 0, nearest = 0, farthest = 0;
  double noise = 0;  // the height's error, relative
};
LightReach ReachOf(const PlaneView& plane, const Vec3d& light);

// Lights that do not fade, one coordinate or channel after the other. TakeLights makes irradiance
// (r, g, b) strength, which is irradiance times the light's height above the plane.
class NodeLights {
 public:
  // So many are looked at side by side: there is always room for whole blocks.
  static constexpr size_t kBlock = 8;

  void Add(const Vec3d& position, const Rgb& light) {
    if (size == x.size()) Grow(size + 1);
    Set(size++, position, light);
  }
  // Those of the lights that are points and do not fade, in the place of all that are here.
  void Assign(const std::vector<Light>& lights, const std::vector<size_t>& which) {
    if (x.size() < which.size()) Grow(which.size());
    size_t count = 0;
    for (const size_t i : which) {
      const Light& light = lights[i];
      // Most are: the others are written, too, and not counted.
      Set(count, light.position, light.irradiance);
      count += IsPlain(light) ? 1 : 0;
    }
    size = count;
  }
  static bool IsPlain(const Light& light) {
    return light.kind == LightKind::kPoint && !(light.fade_distance > 0);
  }

  size_t size = 0;
  std::vector<double> x, y, z, r, g, b;
  // By block, a bit for each light: what TakeLights has found out.
  std::vector<uint8_t> taken, behind;
  // Whether each of the first `count` lights, of which TakeLights was told, is one or the other.
  bool AreSettled(size_t count) const;

 private:
  void Grow(size_t count);
  void Set(size_t i, const Vec3d& position, const Rgb& light) {
    x[i] = position.x;
    y[i] = position.y;
    z[i] = position.z;
    r[i] = light.r;
    g[i] = light.g;
    b[i] = light.b;
  }
};

// Sums over lights of what is known of their terms, channel by channel. Lights go to the lanes in
// turn, whatever the machine's vectors, so that sums have the same bits on all of them.
struct TermSums {
  struct Lanes {
    alignas(64) std::array<double, NodeLights::kBlock> r{}, g{}, b{};
    Rgb Sum() const;
  };
  Lanes error, least, most;
};

// Says which lights are taken and which are behind, adds those that are taken to the sums and
// leaves no others in `lights`. With the best vectors of this machine, and one number after the
// other: both give the same bits.
void TakeLights(const PlaneView& plane, NodeLights& lights, TermSums& sums);
void TakeLightsScalar(const PlaneView& plane, NodeLights& lights, TermSums& sums);

// The first guess halves the exponent and lets a line stand for the mantissa's root: off by 0.0343
// at most. What is off by d is off by 1.5 d^2 and less after a step of Newton's.
inline constexpr uint64_t kInverseRootBits = 0x5FE6EB50C7B537A9;
inline constexpr int kInverseRootSteps = 3;

// Of InverseRoot, relative: three of Newton's steps make of 0.0343 3.4e-11 = 0.59 * 2^-34.
inline constexpr double kInverseRootRounding = 0x1p-34;

// 1 / sqrt(x) for x in [2^-1000, 2^1000], by operations that vectors have, too.
double InverseRoot(double x);

// Adds strength / |position - place| of all lights to the sums, in their order; |...| by
// InverseRoot. Both give the same bits, as above.
void AddPointLights(const NodePlaces& places, const NodeLights& lights, NodeSums& sums);
void AddPointLightsScalar(const NodePlaces& places, const NodeLights& lights, NodeSums& sums);

}  // namespace linetree
