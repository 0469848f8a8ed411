#include "core/audit/comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace linetree {
namespace {

constexpr double kFloor = 1.0 / 1024;
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Rgb Rounded(const Rgb& rgb) {
  return {static_cast<float>(rgb.r), static_cast<float>(rgb.g), static_cast<float>(rgb.b)};
}

TEST(ComparisonTest, EqualIsNoError) {
  const Comparison same = Compare({1, 0, 3}, {1, 0, 3}, 0, kFloor);
  EXPECT_TRUE(same.equal);
  EXPECT_EQ(same.error_over_allowed, 0);
  EXPECT_FALSE(same.IsViolation());
}

TEST(ComparisonTest, AtEpsilonZeroEveryBitCounts) {
  for (const Rgb& answer : {Rgb{std::nextafter(1.0, 2), 0, 0}, Rgb{1, -0.0, 0}, Rgb{1, 0, kNan}}) {
    const Comparison off = Compare(answer, {1, 0, 0}, 0, kFloor);
    EXPECT_FALSE(off.equal);
    EXPECT_TRUE(off.IsViolation());
    EXPECT_EQ(off.error_over_allowed, kInf);
  }
}

TEST(ComparisonTest, ErrorsAreRelativeToTheClassicalRadiance) {
  EXPECT_NEAR(Compare({1.05, 2, 2}, {1, 2, 2}, 0.1, kFloor).error_over_allowed, 0.5, 1e-12);
  EXPECT_NEAR(Compare({1, 1.7, 2}, {1, 2, 2}, 0.1, kFloor).error_over_allowed, 1.5, 1e-12);
  EXPECT_FALSE(Compare({1.0999, 1, 1}, {1, 1, 1}, 0.1, kFloor).IsViolation());
  EXPECT_TRUE(Compare({1, 1, 1.1001}, {1, 1, 1}, 0.1, kFloor).IsViolation());
}

TEST(ComparisonTest, BelowTheFloorErrorsAreRelativeToIt) {
  EXPECT_FALSE(Compare({0.09 * kFloor, 0, 0}, {}, 0.1, kFloor).IsViolation());
  EXPECT_TRUE(Compare({0.11 * kFloor, 0, 0}, {}, 0.1, kFloor).IsViolation());
}

TEST(ComparisonTest, WhatIsNoNumberIsAViolationUnlessClassicalToo) {
  EXPECT_TRUE(Compare({kNan, 0, 0}, {1, 0, 0}, 0.1, kFloor).IsViolation());
  EXPECT_TRUE(Compare({1, 0, 0}, {kNan, 0, 0}, 0.1, kFloor).IsViolation());
  EXPECT_TRUE(Compare({kInf, 0, 0}, {1, 0, 0}, 0.1, kFloor).IsViolation());
  EXPECT_FALSE(Compare({kNan, 0, 0}, {kNan, 0, 0}, 0, kFloor).IsViolation());
}

TEST(ComparisonTest, RoundingToFloatIsAllowedAndNoMore) {
  const Rgb classical{0.1, 1.0 / 3, 1e-42};
  EXPECT_TRUE(CompareRounded(Rounded(classical), classical, 0, kFloor).equal);
  const double above = std::nextafterf(0.1f, 1);
  EXPECT_TRUE(CompareRounded({above, 1.0 / 3, 0}, classical, 0, kFloor).IsViolation());
  // An answer at the very end of what is allowed stays within it when it is rounded upwards.
  for (const double radiance : {0.1, 0.7, 1.0, 3.3, 1e-4, 1e-44, 1e30}) {
    for (const double epsilon : {1e-9, 0.02, 0.25}) {
      const double end = radiance + epsilon * std::max(radiance, kFloor);
      const Rgb answer = Rounded({end, end, end});
      const Rgb grey{radiance, radiance, radiance};
      EXPECT_LE(CompareRounded(answer, grey, epsilon, kFloor).error_over_allowed, 1 + 1e-6)
          << radiance << " " << epsilon;
    }
  }
  EXPECT_TRUE(CompareRounded({1.11, 1, 1}, {1, 1, 1}, 0.1, kFloor).IsViolation());
}

TEST(ComparisonTest, WhatIsTooLargeForAFloatMayBeInfinite) {
  EXPECT_FALSE(CompareRounded({kInf, 0, 0}, {1e39, 0, 0}, 0.1, kFloor).IsViolation());
  EXPECT_TRUE(CompareRounded({kInf, 0, 0}, {1e38, 0, 0}, 0.1, kFloor).IsViolation());
}

}  // namespace
}  // namespace linetree
