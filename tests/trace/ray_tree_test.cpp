#include "core/trace/ray_tree.h"

#include <gtest/gtest.h>

#include <functional>

namespace linetree {
namespace {

RayTree SomeTree() {
  RayTree tree;
  tree.nodes.resize(2);
  tree.nodes[0].object = 3;
  tree.nodes[0].face = 1;
  tree.nodes[0].first_light = 0;
  tree.nodes[1].kind = NodeKind::kBackground;
  tree.nodes[1].branch = Branch::kReflected;
  tree.nodes[1].parent = 0;
  tree.lights.resize(2);
  tree.lights[0].state = LightState::kLit;
  tree.lights[1].state = LightState::kBlocked;
  tree.lights[1].occluder = 4;
  return tree;
}

TEST(RayTree, EveryLabelCounts) {
  const RayTree tree = SomeTree();
  EXPECT_TRUE(SameTopology(tree, SomeTree()));
  const std::vector<std::function<void(RayTree&)>> changes = {
      [](RayTree& t) { t.nodes[0].kind = NodeKind::kCutOff; },
      [](RayTree& t) { t.nodes[1].branch = Branch::kTransmitted; },
      [](RayTree& t) { t.nodes[0].side = Side::kInside; },
      [](RayTree& t) { t.nodes[0].object = 2; },
      [](RayTree& t) { t.nodes[0].face = 0; },
      [](RayTree& t) { t.nodes[0].total_reflection = true; },
      [](RayTree& t) { t.nodes[1].parent = 1; },
      [](RayTree& t) { t.lights[0].state = LightState::kFacingAway; },
      [](RayTree& t) { t.lights[0].crossings = 17; },
      [](RayTree& t) { t.lights.pop_back(); },
      [](RayTree& t) { t.nodes.pop_back(); },
  };
  for (size_t i = 0; i < changes.size(); ++i) {
    RayTree changed = SomeTree();
    changes[i](changed);
    EXPECT_FALSE(SameTopology(tree, changed)) << "change " << i;
  }
}

TEST(RayTree, GeometryAndOccludersDoNotCount) {
  RayTree other = SomeTree();
  other.lights[1].occluder = 5;
  other.nodes[0].point = {1, 2, 3};
  other.radiance = {1, 1, 1};
  EXPECT_TRUE(SameTopology(SomeTree(), other));
}

}  // namespace
}  // namespace linetree
