#include "core/tree/interpolant.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/random.h"

namespace linetree {
namespace {

RayCoords RandomCoords(test::Random& random) {
  return {random.Uniform(0, 1), random.Uniform(0, 1), random.Uniform(0, 1), random.Uniform(0, 1)};
}

TEST(InterpolantTest, ReproducesMultilinearFunctions) {
  test::Random random(3);
  double largest = 0;
  for (int trial = 0; trial < 500; ++trial) {
    std::array<double, 16> c;
    for (double& v : c) v = random.Uniform(0, 1);
    const auto f = [&](const RayCoords& x) {
      double sum = 0;
      for (size_t m = 0; m < 16; ++m) {
        double term = c[m];
        for (size_t k = 0; k < 4; ++k) {
          if ((m >> k & 1) != 0) term *= x[k];
        }
        sum += term;
      }
      return sum;
    };
    Interpolant interpolant;
    for (size_t m = 0; m < 16; ++m) {
      RayCoords x;
      for (size_t k = 0; k < 4; ++k) x[k] = static_cast<double>(m >> k & 1);
      interpolant.corner[m].fill(static_cast<float>(f(x)));
    }
    for (int i = 0; i < 20; ++i) {
      const RayCoords x = RandomCoords(random);
      largest = std::max(largest, std::abs(Evaluate(interpolant, x).g / f(x) - 1));
    }
  }
  RecordProperty("largest_relative_error", std::to_string(largest));
  EXPECT_LE(largest, kStorageRounding);
}

TEST(InterpolantTest, EqualCornersComeBackExactly) {
  test::Random random(4);
  for (int i = 0; i < 1000; ++i) {
    Interpolant interpolant;
    const auto value = static_cast<float>(random.LogUniform(1e-30, 1e30));
    for (auto& corner : interpolant.corner) corner.fill(value);
    ASSERT_EQ(Evaluate(interpolant, RandomCoords(random)).r, static_cast<double>(value));
  }
}

TEST(InterpolantTest, StaysBetweenTheCorners) {
  test::Random random(5);
  for (int i = 0; i < 2000; ++i) {
    Interpolant interpolant;
    double lo = 1e300, hi = -1e300;
    for (auto& corner : interpolant.corner) {
      corner.fill(static_cast<float>(random.Uniform(0, 1)));
      lo = std::min(lo, static_cast<double>(corner[0]));
      hi = std::max(hi, static_cast<double>(corner[0]));
    }
    const double v = Evaluate(interpolant, RandomCoords(random)).b;
    ASSERT_GE(v, lo * (1 - kStorageRounding));
    ASSERT_LE(v, hi * (1 + kStorageRounding));
  }
}

TEST(InterpolantTest, LocalCoordsRunFromZeroToOneInTheCell) {
  CellId cell;
  cell.depth = 2;
  cell.index = {1, 0, 3, 2};
  EXPECT_EQ(LocalCoords(cell, CoordsOfGrid(cell.Corner(0))), (RayCoords{0, 0, 0, 0}));
  EXPECT_EQ(LocalCoords(cell, CoordsOfGrid(cell.Corner(15))), (RayCoords{1, 1, 1, 1}));
}

}  // namespace
}  // namespace linetree
