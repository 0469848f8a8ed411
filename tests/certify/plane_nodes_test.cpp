#include "core/certify/plane_nodes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <iostream>
#include <limits>

#include "tests/support/every_target.h"
#include "tests/support/random.h"

namespace linetree::test {
namespace {

NodeLights LightsOf(Random& random, size_t count) {
  NodeLights lights;
  for (size_t i = 0; i < count; ++i) {
    lights.Add(random.Direction() * random.LogUniform(4, 1e6),
               {random.Unit(), random.LogUniform(1e-30, 1e30), 0});
  }
  return lights;
}

void ExpectSame(const NodeLights& a, const NodeLights& b, size_t blocks, const char* name) {
  ASSERT_EQ(a.size, b.size) << name;
  for (size_t i = 0; i < a.size; ++i) {
    EXPECT_EQ((Vec3d{a.x[i], a.y[i], a.z[i]}), (Vec3d{b.x[i], b.y[i], b.z[i]})) << name;
    EXPECT_EQ((Rgb{a.r[i], a.g[i], a.b[i]}), (Rgb{b.r[i], b.g[i], b.b[i]})) << name;
  }
  for (size_t i = 0; i < blocks; ++i) {
    EXPECT_EQ(a.taken[i], b.taken[i]) << name;
    EXPECT_EQ(a.behind[i], b.behind[i]) << name;
  }
}
void ExpectSame(const TermSums::Lanes& a, const TermSums::Lanes& b, const char* name) {
  EXPECT_EQ(a.r, b.r) << name;
  EXPECT_EQ(a.g, b.g) << name;
  EXPECT_EQ(a.b, b.b) << name;
}

TEST(PlaneNodes, EveryTargetGivesTheScalarTwinsBits) {
  Random random(1);
  NodePlaces places;
  for (size_t k = 0; k < kPlaneNodes; ++k) {
    const Vec3d place = random.InCube(2);
    places.x[k] = place.x;
    places.y[k] = place.y;
    places.z[k] = place.z;
  }
  for (const size_t count : {0, 1, 7, 128}) {
    const NodeLights lights = LightsOf(random, count);
    NodeSums expected;
    AddPointLightsScalar(places, lights, expected);
    const int targets = ForEveryTarget([&](const char* name) {
      NodeSums sums;
      AddPointLights(places, lights, sums);
      EXPECT_EQ(sums.r, expected.r) << name;
      EXPECT_EQ(sums.g, expected.g) << name;
      EXPECT_EQ(sums.b, expected.b) << name;
    });
    EXPECT_GE(targets, 1);
  }
}

// Lights in front, behind, in the plane, near, and far beyond what numbers hold; and, of 24, whole
// vectors in front.
TEST(PlaneNodes, EveryTargetTakesTheLightsThatTheScalarTwinTakes) {
  Random random(2);
  size_t taken = 0, behind = 0, others = 0;
  for (const size_t count : {1, 5, 8, 9, 24, 128}) {
    const PlaneView plane{random.Direction(), random.InCube(2), 0.5, 3, 1e-9, 1e-5};
    NodeLights lights = LightsOf(random, count);
    for (size_t i = 0; count == 24 && i < count; ++i) {
      const Vec3d front = plane.center + plane.normal * random.LogUniform(20, 1e6);
      lights.x[i] = front.x;
      lights.y[i] = front.y;
      lights.z[i] = front.z;
      // Past the first of the second vector that is left out, others move.
      if (i == 13) lights.y[i] = std::numeric_limits<double>::quiet_NaN();
    }
    if (count > 24) {
      lights.x[3] = 1e300;
      lights.y[4] = std::numeric_limits<double>::quiet_NaN();
      lights.z[5] = std::numeric_limits<double>::infinity();
      const Vec3d near = plane.center + plane.normal * 1e-3;
      lights.x[7] = near.x;
      lights.y[7] = near.y;
      lights.z[7] = near.z;
    }
    const size_t blocks = (count + NodeLights::kBlock - 1) / NodeLights::kBlock;
    NodeLights expected = lights;
    TermSums expected_sums;
    TakeLightsScalar(plane, expected, expected_sums);
    ForEveryTarget([&](const char* name) {
      NodeLights found = lights;
      TermSums sums;
      TakeLights(plane, found, sums);
      ExpectSame(found, expected, blocks, name);
      ExpectSame(sums.error, expected_sums.error, name);
      ExpectSame(sums.least, expected_sums.least, name);
      ExpectSame(sums.most, expected_sums.most, name);
    });
    taken += expected.size;
    for (size_t i = 0; i < blocks; ++i)
      behind += static_cast<size_t>(std::popcount(expected.behind[i]));
    others += count;
  }
  others -= taken + behind;
  EXPECT_GT(taken, 10u);
  EXPECT_GT(behind, 10u);
  EXPECT_GE(others, 4u);
}

// One that is neither taken nor behind, wherever it is, is noticed.
TEST(PlaneNodes, LightsAreSettledWhereEachIsTakenOrBehind) {
  Random random(4);
  const PlaneView plane{{0, 0, 1}, {}, 0.5, 3, 1e-9, 1e-5};
  for (const size_t count : {1, 8, 13}) {
    for (size_t open = 0; open <= count; ++open) {
      NodeLights lights;
      for (size_t i = 0; i < count; ++i)
        lights.Add({0, 0, random.Below(2) ? 1e3 : -1e3}, {1, 1, 1});
      if (open < count) lights.z[open] = 1e-3;
      TermSums sums;
      TakeLights(plane, lights, sums);
      EXPECT_EQ(lights.AreSettled(count), open == count) << open << " of " << count;
    }
  }
}

TEST(PlaneNodes, InverseRootsKeepTheirBound) {
  Random random(3);
  double largest = 0;
  const auto look = [&](double x) {
    const double exact = 1 / std::sqrt(x);
    largest = std::max(largest, std::abs(InverseRoot(x) - exact) / exact);
  };
  for (int i = 0; i < 200'000; ++i) look(1 + 3 * (i + random.Unit()) / 200'000);
  for (int i = 0; i < 100'000; ++i) look(random.LogUniform(0x1p-1000, 0x1p1000));
  for (const double x : {0x1p-1000, 0x1p-1, 1.0, 2.0, 4.0, 0x1p1000}) look(x);
  std::cout << "largest error " << largest / kInverseRootRounding << " of the bound\n";
  EXPECT_LE(largest, kInverseRootRounding);
  EXPECT_GE(largest, kInverseRootRounding / 4);
}

}  // namespace
}  // namespace linetree::test
