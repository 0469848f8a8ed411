// Reproducible random numbers: the same on every machine, from a seed that a report can name.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/math/rgb.h"
#include "core/math/vec3.h"

namespace linetree {

// Spreads 64 bits over 64 bits, one to one (the finalizer of SplitMix64: Steele, Lea, Flood, 2014).
inline uint64_t MixBits(uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

class RandomStream {
 public:
  explicit RandomStream(uint64_t seed) : state_(seed) {}

  uint64_t Bits() { return MixBits(state_ += 0x9e3779b97f4a7c15u); }
  // In [0, 1).
  double Unit() { return static_cast<double>(Bits() >> 11) * 0x1p-53; }
  double Uniform(double low, double high) { return low + (high - low) * Unit(); }
  double LogUniform(double low, double high) {
    return std::exp(Uniform(std::log(low), std::log(high)));
  }
  // In [0, count).
  int Below(int count) { return static_cast<int>(Unit() * count); }
  size_t Index(size_t count) { return static_cast<size_t>(Unit() * static_cast<double>(count)); }
  bool OneIn(int count) { return Below(count) == 0; }
  double Sign() { return OneIn(2) ? -1 : 1; }
  // A multiple of 2^-bits in [0, 1], both ends included.
  double Dyadic(int bits) { return std::ldexp(static_cast<double>(Below((1 << bits) + 1)), -bits); }

  Vec3d InBox(const Vec3d& low, const Vec3d& high) {
    const double x = Uniform(low.x, high.x);
    const double y = Uniform(low.y, high.y);
    return {x, y, Uniform(low.z, high.z)};
  }
  Vec3d InCube(double half) { return InBox({-half, -half, -half}, {half, half, half}); }
  // Unit vector, uniform on the sphere.
  Vec3d Direction() {
    const double z = Uniform(-1, 1);
    const double angle_rad = Uniform(0, 2 * std::numbers::pi);
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(angle_rad), r * std::sin(angle_rad), z};
  }
  // Channels in [low, high].
  Rgb RandomRgb(double low, double high) {
    const double r = Uniform(low, high);
    const double g = Uniform(low, high);
    return {r, g, Uniform(low, high)};
  }

 private:
  uint64_t state_;
};

}  // namespace linetree
