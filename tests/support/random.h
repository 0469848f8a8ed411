// Reproducible random numbers for tests: the same on every machine, from a printed seed.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "core/math/vec3.h"

namespace linetree::test {

class Random {
 public:
  explicit Random(uint64_t seed) : engine_(seed) {}

  // In [0, 1).
  double Unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double Uniform(double low, double high) { return low + (high - low) * Unit(); }
  double LogUniform(double low, double high) {
    return std::exp(Uniform(std::log(low), std::log(high)));
  }
  // In [0, count).
  int Below(int count) { return static_cast<int>(Unit() * count); }
  // In [low, high], both ends included.
  int Int(int low, int high) { return low + Below(high - low + 1); }
  Vec3d InBox(const Vec3d& low, const Vec3d& high) {
    const double x = Uniform(low.x, high.x);
    const double y = Uniform(low.y, high.y);
    return {x, y, Uniform(low.z, high.z)};
  }
  Vec3d InCube(double half) {
    const double x = Uniform(-half, half);
    const double y = Uniform(-half, half);
    return {x, y, Uniform(-half, half)};
  }
  // Unit vector, uniform on the sphere.
  Vec3d Direction() {
    const double z = Uniform(-1, 1);
    const double angle = Uniform(0, 2 * std::numbers::pi);
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace linetree::test
