#include "core/tree/shaft.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/random.h"

namespace linetree {
namespace {

Box3 RandomBox(test::Random& random, double size) {
  Box3 box;
  const Vec3d at = random.InBox({-5, -5, -5}, {5, 5, 5});
  box.Add(at);
  // One time in four flat along an axis, as polygons are.
  Vec3d extent = random.InBox({0, 0, 0}, {size, size, size});
  if (random.Int(0, 3) == 0) extent[random.Int(0, 2)] = 0;
  box.Add(at + extent);
  return box;
}

// The only promise that judges rely on: what a segment of the bundle touches is never missed.
TEST(ShaftTest, NeverMissesABoxThatASegmentTouches) {
  test::Random random(6);
  for (int i = 0; i < 200000; ++i) {
    const Box3 from = RandomBox(random, 2), to = RandomBox(random, 2);
    const Vec3d a = random.InBox(from.min, from.max), b = random.InBox(to.min, to.max);
    Box3 blocker;
    const Vec3d on = a + (b - a) * random.Uniform(0, 1);
    blocker.Add(on);
    blocker.Add(on + random.InBox({-1, -1, -1}, {1, 1, 1}));
    ASSERT_FALSE(Shaft(from, to).Misses(blocker)) << "seed 6, case " << i;
  }
}

// The blocker's corner is the middle of a segment between like corners, exactly: it lies on the
// very plane that would part them, and nothing but kShaftRounding keeps rounding from doing so.
TEST(ShaftTest, RoundingPartsNothingThatTouches) {
  test::Random random(8);
  // Multiples of 2^-24 below 2^24: sums and halves of them are exact.
  const auto point = [&](double size) {
    Vec3d p;
    for (int i = 0; i < 3; ++i)
      p[i] = std::ldexp(std::floor(random.Uniform(-size, size) * 0x1p24), -24);
    return p;
  };
  for (int i = 0; i < 200000; ++i) {
    const Vec3d at = point(random.LogUniform(1, 0x1p23));
    const Vec3d a = at + point(4), b = at + point(4), on = (a + b) * 0.5;
    // Both boxes lie on one side of the plane through a and b along an axis, the blocker on the
    // other.
    const int axis = random.Int(0, 2), u = (axis + 1) % 3, v = (axis + 2) % 3;
    const bool rises = (b[u] > a[u]) == (b[v] > a[v]);
    const double side = random.Int(0, 1) == 0 ? 1 : -1;
    Vec3d inner;
    inner[axis] = 1;
    inner[u] = side;
    inner[v] = rises ? -side : side;
    Box3 from, to, blocker;
    from.Add(a);
    from.Add(a + inner);
    to.Add(b);
    to.Add(b + inner);
    blocker.Add(on);
    blocker.Add(on - inner);
    ASSERT_FALSE(Shaft(from, to).Misses(blocker)) << "seed 8, case " << i;
  }
}

// Exact for boxes in general position seen along an axis; elsewhere nearly so.
TEST(ShaftTest, SeesThatMostDisjointBoxesMiss) {
  test::Random random(7);
  int disjoint = 0, missed = 0;
  for (int i = 0; i < 20000; ++i) {
    const Box3 from = RandomBox(random, 1), to = RandomBox(random, 1);
    const Box3 other = RandomBox(random, 1);
    bool touched = false;
    for (int s = 0; s < 200 && !touched; ++s) {
      const Vec3d a = random.InBox(from.min, from.max), b = random.InBox(to.min, to.max);
      for (int t = 0; t <= 20 && !touched; ++t) {
        touched = other.Contains(a + (b - a) * (t / 20.0));
      }
    }
    if (touched) continue;
    ++disjoint;
    if (Shaft(from, to).Misses(other)) ++missed;
  }
  EXPECT_GT(disjoint, 10000);
  EXPECT_GT(missed, disjoint * 95 / 100) << missed << " of " << disjoint;
}

TEST(ShaftTest, TheDiagonalGapIsSeen) {
  // The bounding box of both ends holds the blocker, the hull does not.
  Box3 from, to, blocker;
  from.Add(Vec3d{0, 0, 0});
  from.Add(Vec3d{1, 1, 1});
  to.Add(Vec3d{9, 9, 0});
  to.Add(Vec3d{10, 10, 1});
  blocker.Add(Vec3d{7, 1, 0});
  blocker.Add(Vec3d{8, 2, 1});
  EXPECT_TRUE(Shaft(from, to).Misses(blocker));
  Box3 wide = blocker;
  wide.Add(Vec3d{5, 5, 0});
  EXPECT_FALSE(Shaft(from, to).Misses(wide));
}

}  // namespace
}  // namespace linetree
