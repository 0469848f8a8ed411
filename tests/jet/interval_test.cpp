#include "core/jet/interval.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/jet/taylor.h"

namespace linetree {
namespace {

using test::Random;
using test::Wide;
using test::WideRoot;

constexpr double kInf = std::numeric_limits<double>::infinity();

// Any sign, any size in [1e-low, 1e+high]; sometimes 0 or denormal.
double AnyDouble(Random& random, double low, double high) {
  const int kind = random.Below(20);
  if (kind == 0) return 0;
  if (kind == 1) return random.Uniform(-64, 64) * std::numeric_limits<double>::denorm_min();
  const double size = std::pow(10, random.Uniform(-low, high));
  return random.Below(2) == 0 ? size : -size;
}
Interval AnyInterval(Random& random, double low, double high) {
  const double a = AnyDouble(random, low, high);
  // Two times in three a narrow one.
  const double b = random.Below(3) == 0 ? AnyDouble(random, low, high)
                                        : a + a * random.LogUniform(1e-17, 1) * random.Int(0, 1);
  return {std::min(a, b), std::max(a, b)};
}
// A point of the interval, at its ends two times in three.
double PointOf(Random& random, const Interval& a) {
  const int kind = random.Below(3);
  if (kind == 0) return a.lo;
  if (kind == 1) return a.hi;
  return std::clamp(a.lo + random.Unit() * (a.hi - a.lo), a.lo, a.hi);
}
bool Holds(const Interval& a, Wide x) { return Wide(a.lo) <= x && x <= Wide(a.hi); }

TEST(Interval, StepsReachTheNextDouble) {
  EXPECT_EQ(kOutward, std::numeric_limits<double>::epsilon());
  Random random(1);
  for (int i = 0; i < 100000; ++i) {
    const double x = AnyDouble(random, 320, 150);
    ASSERT_GE(RoundUp(x), std::nextafter(x, kInf)) << x;
    ASSERT_LE(RoundDown(x), std::nextafter(x, -kInf)) << x;
    // At most three neighbours further.
    ASSERT_LE(RoundUp(x), x + 4 * (std::nextafter(std::abs(x), kInf) - std::abs(x))) << x;
  }
}

TEST(Interval, OperationsEnclose) {
  Random random(2);
  for (int i = 0; i < 200000; ++i) {
    const Interval a = AnyInterval(random, 100, 75), b = AnyInterval(random, 100, 75);
    const double x = PointOf(random, a), y = PointOf(random, b);
    ASSERT_TRUE(a.Contains(x));
    ASSERT_TRUE(Holds(a + b, Wide(x) + Wide(y)));
    ASSERT_TRUE(Holds(a - b, Wide(x) - Wide(y)));
    ASSERT_TRUE(Holds(a * b, Wide(x) * Wide(y))) << x << " " << y;
    ASSERT_TRUE(Holds(-a, -Wide(x)));
    ASSERT_TRUE(Holds(a * y, Wide(x) * Wide(y)));
    ASSERT_TRUE(Holds(a + y, Wide(x) + Wide(y)));
    ASSERT_TRUE(Holds(Square(a), Wide(x) * Wide(x)));
    ASSERT_GE(Square(a).lo, 0);
    ASSERT_GE(a.Magnitude(), std::abs(x));
    ASSERT_GE(Wide(a.Width()), Wide(a.hi) - Wide(a.lo));
  }
}

TEST(Interval, FunctionsEnclose) {
  Random random(3);
  for (int i = 0; i < 100000; ++i) {
    const double low = std::pow(10, random.Uniform(-140, 140));
    const Interval a{low, low * (1 + random.LogUniform(1e-16, 10) * random.Int(0, 1))};
    const double x = PointOf(random, a);
    ASSERT_TRUE(Holds(Inverse(a), 1 / Wide(x)));
    ASSERT_TRUE(Holds(Inverse(-a), -1 / Wide(x)));
    ASSERT_TRUE(Holds(SquareRoot(a), WideRoot(x))) << x;
  }
  EXPECT_EQ(SquareRoot(Interval{0, 0}).lo, 0);
}

// pow itself, and intervals of powers. The truth is powl, off by 2^-63 or so.
TEST(Interval, PowersEnclose) {
  Random random(4);
  const std::vector<double> exponents{-1.5, -1, -0.5, 0.25, 0.5, 1,    1.5,    2,
                                      2.5,  3,  7.75, 20,   80,  99.5, 333.25, 1000};
  double worst = 0;
  for (int i = 0; i < 200000; ++i) {
    const double p = exponents[static_cast<size_t>(random.Below(16))];
    const double low = random.Below(2) == 0 ? random.Uniform(0.5, 1.5) : random.LogUniform(1e-3, 1);
    const Interval a{low, low * (1 + random.LogUniform(1e-16, 0.3) * random.Int(0, 1))};
    const double x = PointOf(random, a);
    const long double truth = std::pow(static_cast<long double>(x), static_cast<long double>(p));
    ASSERT_TRUE(Holds(Power(a, p), truth)) << x << "^" << p;
    if (truth > 1e-300L) {
      const auto off = static_cast<double>(std::abs(std::pow(x, p) / truth - 1));
      worst = std::max(worst, off);
    }
  }
  EXPECT_LE(worst, kPowerRounding);
  EXPECT_LE(worst, 0x1p-52) << "the library's pow is worse than what kPowerRounding is derived of";
  EXPECT_EQ(Power(Interval{0, 0.5}, 3).lo, 0);
}

TEST(Interval, MeetKeepsWhatBothSay) {
  const Interval m = Meet({0, 2}, {1, 3});
  EXPECT_EQ(m.lo, 1);
  EXPECT_EQ(m.hi, 2);
  const Interval parted = Meet({0, 1}, {2, 3});
  EXPECT_EQ(parted.lo, 1);
  EXPECT_EQ(parted.hi, 2);
}

// Outward rounding costs a few steps, no more.
TEST(Interval, StaysNarrow) {
  Random random(5);
  for (int i = 0; i < 100000; ++i) {
    const double x = AnyDouble(random, 50, 50), y = AnyDouble(random, 50, 50);
    const double product = x * y, sum = x + y;
    constexpr double kTiny = 4 * std::numeric_limits<double>::denorm_min();
    ASSERT_LE((Interval{x, x} * Interval{y, y}).Width(), 3 * kOutward * std::abs(product) + kTiny);
    ASSERT_LE((Interval{x, x} + Interval{y, y}).Width(), 3 * kOutward * std::abs(sum) + kTiny);
  }
}

}  // namespace
}  // namespace linetree
