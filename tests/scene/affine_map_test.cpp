#include "core/scene/affine_map.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace linetree
