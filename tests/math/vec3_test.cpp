#include "core/math/vec3.h"

#include <gtest/gtest.h>

#include <limits>
#include <type_traits>

#include "tests/support/random.h"

namespace linetree {
namespace {

using test::Random;

TEST(Vec3, ProductsAreTheTextbooks) {
  const Vec3d a{1, 2, 3}, b{-4, 5, 6};
  EXPECT_EQ(a + b, (Vec3d{-3, 7, 9}));
  EXPECT_EQ(a - b, (Vec3d{5, -3, -3}));
  EXPECT_EQ(-a, (Vec3d{-1, -2, -3}));
  EXPECT_EQ(a * 2.0, (Vec3d{2, 4, 6}));
  EXPECT_EQ(Dot(a, b), 24);
  EXPECT_EQ(Cross(a, b), (Vec3d{-3, -18, 13}));
  EXPECT_EQ(Length(Vec3d{2, 3, 6}), 7);
  EXPECT_EQ(Normalized(Vec3d{0, 0, 4}), (Vec3d{0, 0, 1}));
}

TEST(Vec3, IndexIsTheCoordinate) {
  Vec3d a{1, 2, 3};
  for (int i = 0; i < 3; ++i) EXPECT_EQ(a[i], i + 1);
  a[1] = 7;
  EXPECT_EQ(a.y, 7);
}

TEST(Vec3, TheWiderScalarWins) {
  const Vec3<long double> a{1, 2, 3};
  const Vec3d b{4, 5, 6};
  static_assert(std::is_same_v<decltype(a + b), Vec3<long double>>);
  static_assert(std::is_same_v<decltype(Dot(a, b)), long double>);
  static_assert(std::is_same_v<decltype(Mat3{} * a), Vec3<long double>>);
  EXPECT_EQ(CastVec3<double>(a + b), (Vec3d{5, 7, 9}));
}

TEST(Vec3, FiniteMeansEveryCoordinate) {
  EXPECT_TRUE(IsFinite({1, 2, 3}));
  for (int i = 0; i < 3; ++i) {
    Vec3d a{1, 2, 3};
    a[i] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(IsFinite(a));
    a[i] = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(IsFinite(a));
  }
}

TEST(Mat3, RowsMultiplyAndColumnsMultiplyTransposed) {
  const Mat3 m{{Vec3d{1, 2, 3}, Vec3d{4, 5, 6}, Vec3d{7, 8, 10}}};
  EXPECT_EQ(m * Vec3d({1, 0, 0}), (Vec3d{1, 4, 7}));
  EXPECT_EQ(MultiplyTransposed(m, Vec3d{1, 0, 0}), (Vec3d{1, 2, 3}));
  Random random(1);
  for (int k = 0; k < 100; ++k) {
    const Vec3d u = random.InCube(1), v = random.InCube(1);
    EXPECT_NEAR(Dot(u, m * v), Dot(MultiplyTransposed(m, u), v), 1e-14);
  }
}

// Against long double, over components of all magnitudes.
TEST(Vec3, RoundingIsAsPublished) {
  using Wide = long double;
  test::Random random(5);
  double dot = 0, cross = 0, normalized = 0;
  const auto component = [&] { return (random.Below(2) * 2 - 1) * random.LogUniform(1e-12, 1e12); };
  for (int i = 0; i < 300'000; ++i) {
    Vec3d a{component(), component(), component()};
    const Vec3d b{component(), component(), component()};
    if (i % 2 == 0) a = a - b * (Dot(a, b) / Dot(b, b));  // products that cancel
    if (i % 7 == 0) a[i % 3] = 0;
    const Vec3<Wide> wa = CastVec3<Wide>(a), wb = CastVec3<Wide>(b);
    const Wide sum = std::abs(wa.x * wb.x) + std::abs(wa.y * wb.y) + std::abs(wa.z * wb.z);
    const auto off = [](double x, Wide truth) { return static_cast<double>(std::abs(x - truth)); };
    dot = std::max(dot, off(Dot(a, b), Dot(wa, wb)) / static_cast<double>(sum));
    const Vec3d c = Cross(a, b), n = Normalized(a);
    const Vec3<Wide> wc = Cross(wa, wb), wn = Normalized(wa);
    for (int k = 0; k < 3; ++k) {
      const int p = (k + 1) % 3, q = (k + 2) % 3;
      const Wide products = std::abs(wa[p] * wb[q]) + std::abs(wa[q] * wb[p]);
      if (products > 0) cross = std::max(cross, off(c[k], wc[k]) / static_cast<double>(products));
      if (a[k] != 0) normalized = std::max(normalized, off(n[k], wn[k]) / std::abs(n[k]));
    }
  }
  std::printf("largest errors: Dot %.3g of %.3g, Cross %.3g of %.3g, Normalized %.3g of %.3g\n",
              dot, kDotRounding, cross, kCrossRounding, normalized, kNormalizedRounding);
  EXPECT_LE(dot, kDotRounding);
  EXPECT_LE(cross, kCrossRounding);
  EXPECT_LE(normalized, kNormalizedRounding);
}

}  // namespace
}  // namespace linetree
