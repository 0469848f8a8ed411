#include "core/math/rgb.h"

#include <gtest/gtest.h>

#include <type_traits>

namespace linetree {
namespace {

TEST(Rgb, ArithmeticIsPerChannel) {
  Rgb a{1, 2, 3};
  const Rgb b{4, 5, 6};
  EXPECT_EQ(a + b, (Rgb{5, 7, 9}));
  EXPECT_EQ(a * b, (Rgb{4, 10, 18}));
  EXPECT_EQ(Scaled(a, 2.0), (Rgb{2, 4, 6}));
  a += b;
  EXPECT_EQ(a, (Rgb{5, 7, 9}));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(b[i], 4 + i);
  EXPECT_EQ(MaxChannel({1, 9, 3}), 9);
}

TEST(Rgb, TheWiderScalarWins) {
  static_assert(std::is_same_v<decltype(Scaled(Rgb{}, 1.0L)), RgbOf<long double>>);
  static_assert(std::is_same_v<decltype(Rgb{} * RgbOf<long double>{}), RgbOf<long double>>);
}

TEST(Rgb, BlackMeansEveryChannel) {
  EXPECT_TRUE(IsBlack({0, 0, 0}));
  EXPECT_FALSE(IsBlack({1e-300, 0, 0}));
  EXPECT_FALSE(IsBlack({0, 1, 0}));
  EXPECT_FALSE(IsBlack({0, 0, 1}));
}

}  // namespace
}  // namespace linetree
