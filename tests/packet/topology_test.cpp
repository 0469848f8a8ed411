#include "core/packet/topology.h"

#include <gtest/gtest.h>

#include "core/trace/tracer.h"
#include "tests/support/random_scene.h"

namespace linetree::test {
namespace {

// Digests are equal where SameTopology says so and, among thousands of pairs, nowhere else. (What
// filters a light counts only as yes or no in a digest; this scene's filters are single objects.)
TEST(Topology, DigestsTellTreesApart) {
  Random random(3);
  const Scene scene = RandomScene(random, 12, 2);
  const Tracer tracer(scene);
  std::vector<RayTree> trees(150);
  RayCounts counts;
  for (RayTree& tree : trees) {
    const Vec3d eye = random.Direction() * 5;
    tracer.Radiance(eye, Normalized(random.InCube(2) - eye), {}, counts, &tree);
  }
  int same = 0;
  for (const RayTree& a : trees) {
    for (const RayTree& b : trees) {
      if (SameTopology(a, b)) {
        EXPECT_EQ(TopologyDigest(a), TopologyDigest(b));
        ++same;
      }
    }
  }
  EXPECT_GT(same, 150);
}

TEST(Topology, EveryLabelCounts) {
  RayTree tree;
  tree.nodes.resize(2);
  tree.nodes[0].object = 3;
  tree.nodes[0].first_light = 0;
  tree.nodes[1].kind = NodeKind::kBackground;
  tree.nodes[1].branch = Branch::kReflected;
  tree.nodes[1].parent = 0;
  tree.lights.resize(1);
  tree.lights[0].state = LightState::kLit;
  const uint64_t digest = TopologyDigest(tree);
  const auto differs = [&](auto change) {
    RayTree other = tree;
    change(other);
    return TopologyDigest(other) != digest;
  };
  EXPECT_TRUE(differs([](RayTree& t) { t.nodes[0].object = 4; }));
  EXPECT_TRUE(differs([](RayTree& t) { t.nodes[0].face = 1; }));
  EXPECT_TRUE(differs([](RayTree& t) { t.nodes[0].side = Side::kInside; }));
  EXPECT_TRUE(differs([](RayTree& t) { t.nodes[0].total_reflection = true; }));
  EXPECT_TRUE(differs([](RayTree& t) { t.nodes[1].branch = Branch::kTransmitted; }));
  EXPECT_TRUE(differs([](RayTree& t) { t.lights[0].state = LightState::kBlocked; }));
  EXPECT_TRUE(differs([](RayTree& t) { t.lights[0].crossings = 7; }));
}

}  // namespace
}  // namespace linetree::test
