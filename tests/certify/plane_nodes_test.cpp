#include "core/certify/plane_nodes.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/every_target.h"
#include "tests/support/random.h"

namespace linetree::test {
namespace {

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
    std::vector<NodeLight> lights;
    for (size_t i = 0; i < count; ++i) {
      lights.push_back({random.Direction() * random.LogUniform(4, 1e6),
                        {random.Unit(), random.LogUniform(1e-30, 1e30), 0}});
    }
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

}  // namespace
}  // namespace linetree::test
