#include "core/packet/packet_scene.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/random_scene.h"

namespace linetree::test {
namespace {

// Every object is below exactly one child, within that child's box and those above it.
class Walk {
 public:
  Walk(const PacketScene& scene, std::vector<int>& seen) : scene_(scene), seen_(seen) {}

  void Visit(int32_t index, const Box3& box) {
    const PacketNode& node = scene_.nodes()[static_cast<size_t>(index)];
    for (int i = 0; i < kPacketLanes; ++i) {
      if (node.low[0][i] > node.high[0][i]) continue;
      Box3 own;
      for (int axis = 0; axis < 3; ++axis) {
        own.min[axis] = node.low[axis][i] + scene_.reference()[axis];
        own.max[axis] = node.high[axis][i] + scene_.reference()[axis];
      }
      if (node.child[i] >= 0) {
        Visit(node.child[i], own);
        continue;
      }
      const auto object = static_cast<size_t>(~node.child[i]);
      ++seen_[object];
      const Box3& bounds = scene_.scene().objects[object].bounds;
      for (const Box3& around : {own, box}) {
        EXPECT_TRUE(around.Contains(bounds.min) && around.Contains(bounds.max));
      }
    }
  }

 private:
  const PacketScene& scene_;
  std::vector<int>& seen_;
};

TEST(PacketScene, EveryObjectIsInTheHierarchyOnce) {
  for (const int count : {1, 15, 16, 17, 60, 700}) {
    Random random(static_cast<uint64_t>(count));
    const Scene scene = RandomScene(random, count, 5);
    const Tracer tracer(scene);
    const PacketScene packets(tracer);
    ASSERT_TRUE(packets.usable());
    std::vector<int> seen(static_cast<size_t>(count));
    Box3 all;
    all.Add(Vec3d{-1e9, -1e9, -1e9});
    all.Add(Vec3d{1e9, 1e9, 1e9});
    Walk(packets, seen).Visit(0, all);
    for (const int times : seen) EXPECT_EQ(times, 1);
    EXPECT_GT(packets.ByteSize(), static_cast<size_t>(count) * sizeof(PacketShape));
  }
}

TEST(PacketScene, WhatDoesNotFitFloatIsNotUsable) {
  Random random(1);
  const Scene good = RandomScene(random, 4, 2);
  const auto usable = [&](auto change) {
    Scene scene = good;
    change(scene);
    const Tracer tracer(scene);
    return PacketScene(tracer).usable();
  };
  EXPECT_TRUE(usable([](Scene&) {}));
  EXPECT_FALSE(usable([](Scene& s) { s.background.g = 1e-30; }));
  EXPECT_FALSE(usable([](Scene& s) { s.materials[0].diffuse.r = 1e12; }));
  EXPECT_FALSE(usable([](Scene& s) { s.lights[0].irradiance.b = 1e-12; }));
  EXPECT_FALSE(usable([](Scene& s) { s.lights[0].position.x = 1e12; }));
  EXPECT_FALSE(usable([](Scene& s) { s.objects.push_back(ObjectOf(Sphere({0, 0, 0}, 1e-12))); }));
  EXPECT_FALSE(usable([](Scene& s) { s.objects.push_back(ObjectOf(Sphere({1e12, 0, 0}, 1))); }));
  EXPECT_FALSE(usable([](Scene& s) { s.objects.clear(); }));
}

TEST(PacketScene, ClearOfABallIsOutsideItsBox) {
  const Object ball = ObjectOf(Sphere({1, 2, 3}, 2));
  EXPECT_FALSE(IsClearOf(ball, {1, 2, 3}));
  EXPECT_FALSE(IsClearOf(ball, {3, 2, 3}));
  EXPECT_TRUE(IsClearOf(ball, {3.01, 2, 3}));
  EXPECT_TRUE(IsClearOf(ball, {1, 2, -1e9}));
}

}  // namespace
}  // namespace linetree::test
