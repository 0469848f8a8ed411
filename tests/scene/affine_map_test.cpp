#include "core/scene/affine_map.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/random.h"

namespace linetree {
namespace {

void ExpectNear(const Vec3d& a, const Vec3d& b) {
  EXPECT_LE(Length(a - b), 1e-14 * (1 + Length(b)));
}

TEST(AffineMap, StepsAndTheirOrder) {
  ExpectNear(Apply(Translation({1, 2, 3}), {1, 1, 1}), {2, 3, 4});
  ExpectNear(Apply(Scaling({2, -3, 4}), {1, 1, 1}), {2, -3, 4});
  // Right-handed: about z, x turns to y.
  ExpectNear(Apply(Rotation({0, 0, 5}, 90), {1, 0, 0}), {0, 1, 0});
  ExpectNear(Apply(Rotation({1e-200, 0, 0}, 90), {0, 1, 0}), {0, 0, 1});
  const AffineMap map = Then(Scaling({2, 2, 2}), Translation({1, 0, 0}));
  ExpectNear(Apply(map, {1, 0, 0}), {3, 0, 0});
  ExpectNear(Apply(Then(Translation({1, 0, 0}), Scaling({2, 2, 2})), {1, 0, 0}), {4, 0, 0});
}

TEST(AffineMap, InverseUndoesTheLinearPart) {
  const AffineMap map{{{Vec3d{1, 0.5, 0}, Vec3d{0, -2, 0.3}, Vec3d{0.2, 0, 3}}}, {7, 8, 9}};
  const auto inverse = InverseLinear(map);
  ASSERT_TRUE(inverse.ok()) << inverse.status();
  for (const Vec3d& v : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{-3, 2, 5}}) {
    ExpectNear(*inverse * (map.linear * v), v);
  }
  EXPECT_EQ(*InverseLinear(AffineMap{}), Mat3{});
}

TEST(AffineMap, ScalesFarFromOneAreInvertible) {
  for (const double size : {1e-30, 1e-10, 1e10, 1e30}) {
    const auto inverse = InverseLinear(Scaling({size, -size, size}));
    ASSERT_TRUE(inverse.ok()) << size;
    EXPECT_DOUBLE_EQ(inverse->row[1].y, -1 / size);
  }
}

TEST(AffineMap, FlatOnesAreRefused) {
  EXPECT_FALSE(InverseLinear(Scaling({1, 1, 0})).ok());
  EXPECT_FALSE(InverseLinear(Scaling({0, 0, 0})).ok());
  EXPECT_TRUE(InverseLinear(Scaling({1, 1, 2 * kMinReciprocalCondition})).ok());
  EXPECT_FALSE(InverseLinear(Scaling({1, 1, 0.4 * kMinReciprocalCondition})).ok());
  AffineMap broken;
  broken.translation.y = std::nan("");
  EXPECT_FALSE(InverseLinear(broken).ok());
  broken = {};
  broken.linear.row[2].x = INFINITY;
  EXPECT_FALSE(InverseLinear(broken).ok());
}

TEST(Unit, SurvivesTheEndsOfTheRange) {
  for (const double size : {4.9e-324, 1e-300, 1.0, 1e300, 1.7e308}) {
    EXPECT_DOUBLE_EQ(Length(Unit({size, 0, size})), 1) << size;
  }
}

double FrobeniusNorm(const Mat3& m) {
  return std::sqrt(LengthSquared(m.row[0]) + LengthSquared(m.row[1]) + LengthSquared(m.row[2]));
}

TEST(InverseLinear, RoundingIsAsPublished) {
  test::Random random(6);
  double largest = 0;
  int inverted = 0;
  for (int i = 0; i < 100'000; ++i) {
    AffineMap map;
    for (Vec3d& row : map.linear.row) row = random.InCube(1) * random.LogUniform(1e-3, 1e3);
    if (i % 2 == 0) map.linear.row[2] = map.linear.row[0] + random.InCube(1e-9);  // nearly flat
    const auto inverse = InverseLinear(map);
    if (!inverse.ok()) continue;
    ++inverted;
    long double square = 0;
    for (size_t r = 0; r < 3; ++r) {
      const auto row = MultiplyTransposed(map.linear, CastVec3<long double>(inverse->row[r]));
      for (int c = 0; c < 3; ++c) {
        const long double off = row[c] - (static_cast<int>(r) == c ? 1 : 0);
        square += off * off;
      }
    }
    largest = std::max(largest, static_cast<double>(std::sqrt(square)) /
                                    (FrobeniusNorm(map.linear) * FrobeniusNorm(*inverse)));
  }
  std::printf("largest error %.3g, bound %.3g, each times the condition\n", largest,
              kInverseRounding);
  EXPECT_LE(largest, kInverseRounding);
  EXPECT_GT(inverted, 90'000);
}

// Rodrigues' formula in a wider type.
TEST(Rotation, RoundingIsAsPublished) {
  using Wide = long double;
  test::Random random(7);
  double largest = 0;
  for (int i = 0; i < 100'000; ++i) {
    const Vec3d axis = random.Direction() * random.LogUniform(1e-9, 1e9);
    const double angle_deg = random.Uniform(-1, 1) * random.LogUniform(1e-9, 1e5);
    const Mat3 turn = Rotation(axis, angle_deg).linear;
    const Vec3<Wide> u = Normalized(CastVec3<Wide>(axis));
    const Wide angle = angle_deg * (std::numbers::pi_v<Wide> / 180);
    for (int c = 0; c < 3; ++c) {
      Vec3<Wide> unit;
      unit[c] = 1;
      const Vec3<Wide> truth = unit * std::cos(angle) + Cross(u, unit) * std::sin(angle) +
                               u * (u[c] * (1 - std::cos(angle)));
      for (int r = 0; r < 3; ++r) {
        const Wide off = std::abs(turn.row[static_cast<size_t>(r)][c] - truth[r]);
        largest = std::max(largest, static_cast<double>(off / (1 + std::abs(angle))));
      }
    }
  }
  std::printf("largest error %.3g, bound %.3g, each times 1 + angle\n", largest, kRotationRounding);
  EXPECT_LE(largest, kRotationRounding);
}

TEST(Unit, RoundingIsThatOfItsParts) {
  test::Random random(8);
  double largest = 0;
  for (int i = 0; i < 100'000; ++i) {
    const Vec3d v = random.InCube(1) * random.LogUniform(1e-280, 1e280);
    const Vec3<long double> truth = Normalized(CastVec3<long double>(v));
    const Vec3d unit = Unit(v);
    for (int k = 0; k < 3; ++k) {
      const long double off = std::abs((unit[k] - truth[k]) / truth[k]);
      largest = std::max(largest, static_cast<double>(off));
    }
  }
  std::printf("largest error %.3g, bound %.3g\n", largest, kNormalizedRounding + 0x1p-53);
  EXPECT_LE(largest, kNormalizedRounding + 0x1p-53);
}

}  // namespace
}  // namespace linetree
