#include "core/certify/fading.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "tests/jet/taylor.h"

namespace linetree {
namespace {

using test::Wide;
// Coefficients of powers of s.
using Series = std::array<Wide, 5>;

// x^a, of which the value at 0 is given: n x_0 y_n = sum of (a k - (n - k)) x_k y_(n-k).
Series PowerSeries(const Series& x, Wide a, Wide at_0) {
  Series y{at_0};
  for (int n = 1; n < 5; ++n) {
    for (int k = 1; k <= n; ++k) {
      y[static_cast<size_t>(n)] += (a * k - (n - k)) * x[static_cast<size_t>(k)] *
                                   y[static_cast<size_t>(n - k)] / (n * x[0]);
    }
  }
  return y;
}

// F(d) / d along a line as a power series about a place at distance d, `along` of which lies along
// the line; in 113 bits but for the value of (d / D)^p.
Series FadingAlong(const Light& light, double d, double along) {
  const Wide square = Wide(d) * Wide(d);
  const Series q = {square, 2 * Wide(along), 1};
  const Series root = PowerSeries(q, Wide(-0.5), 1 / Wide(d));
  if (light.fade_distance == 0) return root;
  const Wide a = Wide(light.fade_power) / 2;
  Series one_more = PowerSeries(q, a, std::pow(d / light.fade_distance, light.fade_power));
  one_more[0] += 1;
  const Series share = PowerSeries(one_more, Wide(-1), 1 / one_more[0]);
  Series f{};
  for (size_t i = 0; i < 5; ++i) {
    for (size_t k = 0; i + k < 5; ++k) f[i + k] += 2 * root[i] * share[k];
  }
  return f;
}

// In [0, 1], an end one time in three.
double AtEndsOften(test::Random& random) {
  return std::clamp(random.Uniform(-0.25, 1.25), 0.0, 1.0);
}

double SizeOf(Wide x) { return static_cast<double>(x < 0 ? -x : x); }

// Largest |f''''| of samples relative to the bound; all bounds hold.
double Check(const Light& light, double nearest, double farthest, int samples,
             test::Random& random) {
  const FadingBound bound = BoundFading(light, nearest, farthest);
  // Powers in double, as above.
  constexpr double kRounded = 1 + 1e-12;
  double largest = 0;
  for (int i = 0; i < samples; ++i) {
    const double d =
        std::clamp(nearest + AtEndsOften(random) * (farthest - nearest), nearest, farthest);
    const double along = d * AtEndsOften(random);
    const Series f = FadingAlong(light, d, along);
    EXPECT_LE(SizeOf(f[0]), bound.most * kRounded);
    EXPECT_GE(SizeOf(f[0]) * kRounded, bound.least);
    EXPECT_LE(SizeOf(f[1] * Wide(d) / f[0]), bound.slope * kRounded);
    EXPECT_LE(24 * SizeOf(f[4]), bound.fourth * kRounded)
        << "D " << light.fade_distance << ", p " << light.fade_power << ", d " << d << ", along "
        << along;
    largest = std::max(largest, 24 * SizeOf(f[4]) / bound.fourth);
  }
  return largest;
}

TEST(Fading, WithoutItIsLegendresBound) {
  test::Random random(1);
  const Light light;
  EXPECT_GT(Check(light, 2, 2, 100, random), 1 - 1e-9);
  EXPECT_DOUBLE_EQ(BoundFading(light, 2, 3).fourth, 24.0 / 32);
}

TEST(Fading, BoundsHoldAndAreNear) {
  test::Random random(2);
  double worst_exact = 1, worst_narrow = 1;
  for (int i = 0; i < 400; ++i) {
    Light light;
    light.fade_power = i % 4 == 0 ? 2 : random.Uniform(0.05, 8);
    const double nearest = random.LogUniform(1e-3, 1e3);
    light.fade_distance = nearest * random.LogUniform(0.05, 20);
    worst_exact = std::min(worst_exact, Check(light, nearest, nearest, 300, random));
    const double farthest = nearest * random.Uniform(1.02, 1.2);
    worst_narrow = std::min(worst_narrow, Check(light, nearest, farthest, 300, random));
    Check(light, nearest, nearest * random.LogUniform(1.2, 100), 50, random);
  }
  std::printf("largest |f''''| / bound: %.3f at least at one distance, %.3f over up to 1.2 of it\n",
              worst_exact, worst_narrow);
  EXPECT_GT(worst_exact, 0.8);
  EXPECT_GT(worst_narrow, 0.2);
}

TEST(Fading, WhatFadesAwayHasNoBoundThatSaysAnything) {
  Light light;
  light.fade_distance = 1e-200;
  light.fade_power = 8;
  EXPECT_EQ(BoundFading(light, 1, 2).least, 0);
}

}  // namespace
}  // namespace linetree
