#include "core/tree/separable.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/random.h"

namespace linetree {
namespace {

using Directions = std::vector<Vec3d>;

// Plain twin: if a separating plane exists, one exists that almost touches two of the vectors, so
// all pairs are tried, a little turned towards the mean.
bool SeparableByTrial(const Directions& a, const Directions& b) {
  Directions w;
  for (const Vec3d& v : a) w.push_back(-v);
  for (const Vec3d& v : b) w.push_back(v);
  Vec3d mean;
  for (const Vec3d& v : w) mean = mean + v;
  const auto separates = [&](const Vec3d& d) {
    for (const Vec3d& v : w) {
      if (!(Dot(d, v) > 0)) return false;
    }
    return true;
  };
  if (separates(mean)) return true;
  for (const Vec3d& p : w) {
    for (const Vec3d& q : w) {
      const Vec3d n = Cross(p, q);
      if (Length(n) < 1e-12) continue;
      // Turned so that p and q, on the plane, come to the inner side.
      const Vec3d inner = Normalized(p + q) * 1e-7;
      if (separates(Normalized(n) + inner) || separates(-Normalized(n) + inner)) return true;
    }
  }
  return false;
}

Directions Cone(test::Random& random, const Vec3d& axis, double spread, int count) {
  Directions out;
  for (int i = 0; i < count; ++i) out.push_back(Normalized(axis + random.Direction() * spread));
  return out;
}

TEST(SeparableTest, AgreesWithTrialOfAllPlanes) {
  test::Random random(8);
  int yes = 0;
  for (int i = 0; i < 3000; ++i) {
    const Directions a = Cone(random, random.Direction(), random.Uniform(0.01, 1.5), 16);
    const Directions b = Cone(random, random.Direction(), random.Uniform(0.01, 1.5), 16);
    const bool expected = SeparableByTrial(a, b);
    ASSERT_EQ(StrictlySeparable(a, b), expected) << "seed 8, case " << i;
    yes += expected;
  }
  EXPECT_GT(yes, 300);
  EXPECT_LT(yes, 2700);
}

TEST(SeparableTest, ASharedDirectionIsNeverSeparable) {
  test::Random random(9);
  for (int i = 0; i < 2000; ++i) {
    Directions a = Cone(random, random.Direction(), 0.3, 16);
    Directions b = Cone(random, random.Direction(), 0.3, 15);
    b.push_back(a[static_cast<size_t>(random.Int(0, 15))]);
    ASSERT_FALSE(StrictlySeparable(a, b));
    // Nor one inside the other's cone.
    b.back() = Normalized(a[0] + a[5] + a[9]);
    ASSERT_FALSE(StrictlySeparable(a, b));
  }
}

TEST(SeparableTest, OppositeOrNarrowSetsAre) {
  EXPECT_TRUE(StrictlySeparable(Directions{{1, 0, 0}}, Directions{{1, 0.001, 0}}));
  EXPECT_TRUE(StrictlySeparable(Directions{{0, 0, 1}}, Directions{{0, 0, -1}}));
  EXPECT_FALSE(StrictlySeparable(Directions{{0, 0, 1}}, Directions{{0, 0, 1}}));
  EXPECT_TRUE(StrictlySeparable(Directions{}, Directions{}));
  EXPECT_TRUE(StrictlySeparable(Directions{}, Directions{{0, 0, 2}, {0, 3, 0}}));
}

}  // namespace
}  // namespace linetree
