#include "core/trace/bvh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/support/random.h"

namespace linetree {
namespace {

using test::Random;

std::vector<Box3> RandomBoxes(Random& random, int count) {
  std::vector<Box3> boxes;
  for (int i = 0; i < count; ++i) {
    const Vec3d center = random.InCube(10);
    Vec3d half = Vec3d{random.Unit(), random.Unit(), random.Unit()} * random.LogUniform(1e-3, 2);
    if (random.Below(3) == 0) half[random.Below(3)] = 0;  // flat
    boxes.push_back({center - half, center + half});
  }
  return boxes;
}

// What every tree must be: each object once, boxes enclosing what is below, small leaves, limited
// depth.
void ExpectWellFormed(const Bvh& bvh, const std::vector<Box3>& boxes) {
  std::multiset<int32_t> seen;
  const auto visit = [&](auto& self, int32_t index, int depth) -> void {
    ASSERT_LT(depth, Bvh::kMaxDepth);
    const Bvh::Node& node = bvh.nodes()[static_cast<size_t>(index)];
    if (!node.IsLeaf()) {
      for (const int32_t child : {index + 1, node.first}) {
        Box3 both = node.box;
        both.Add(bvh.nodes()[static_cast<size_t>(child)].box);
        EXPECT_EQ(both, node.box);
        self(self, child, depth + 1);
      }
      return;
    }
    EXPECT_LE(node.count, Bvh::kMaxLeaf);
    for (int32_t i = 0; i < node.count; ++i) {
      const int32_t object = bvh.objects()[static_cast<size_t>(node.first + i)];
      Box3 both = node.box;
      both.Add(boxes[static_cast<size_t>(object)]);
      EXPECT_EQ(both, node.box);
      seen.insert(object);
    }
  };
  if (!boxes.empty()) visit(visit, 0, 0);
  EXPECT_EQ(seen.size(), boxes.size());
  EXPECT_EQ(std::set<int32_t>(seen.begin(), seen.end()).size(), boxes.size());
}

TEST(Bvh, HoldsEveryObjectOnce) {
  Random random(1);
  for (const int count : {0, 1, 2, 4, 5, 33, 1000}) {
    const std::vector<Box3> boxes = RandomBoxes(random, count);
    ExpectWellFormed(Bvh(boxes), boxes);
  }
}

TEST(Bvh, EqualCentresAreSplitIntoHalves) {
  const std::vector<Box3> boxes(1000, Box3{{-1, -1, -1}, {1, 1, 1}});
  ExpectWellFormed(Bvh(boxes), boxes);
}

// Each cost split cuts off one object only, until the depth limit takes over.
TEST(Bvh, GeometricSeriesStaysWithinTheDepthLimit) {
  std::vector<Box3> boxes;
  for (int i = 0; i < 900; ++i) {
    const double x = std::ldexp(1.0, -i);
    boxes.push_back({{x, 0, 0}, {x * 1.01, x, x}});
  }
  ExpectWellFormed(Bvh(boxes), boxes);
}

TEST(Bvh, OverlapFindsWhatBruteForceFinds) {
  Random random(2);
  const std::vector<Box3> boxes = RandomBoxes(random, 500);
  const Bvh bvh(boxes);
  for (int k = 0; k < 200; ++k) {
    const Vec3d center = random.InCube(10);
    const Vec3d half = Vec3d{1, 1, 1} * random.Uniform(0, 3);
    const Box3 query{center - half, center + half};
    std::set<int> found, expected;
    bvh.ForEachOverlap([&](const Box3& box) { return box.Overlaps(query); },
                       [&](int object) {
                         if (boxes[static_cast<size_t>(object)].Overlaps(query)) {
                           found.insert(object);
                         }
                         return true;
                       });
    for (size_t i = 0; i < boxes.size(); ++i) {
      if (boxes[i].Overlaps(query)) expected.insert(static_cast<int>(i));
    }
    EXPECT_EQ(found, expected);
  }
}

// Whether the half line meets the box before t_max, in a wider type and with exact parallel cases.
bool Meets(const Box3& box, const Vec3d& origin, const Vec3d& direction, double t_max) {
  long double near = 0;
  long double far = t_max;
  for (int i = 0; i < 3; ++i) {
    if (direction[i] == 0) {
      if (origin[i] < box.min[i] || origin[i] > box.max[i]) return false;
      continue;
    }
    const long double d = direction[i];
    const long double a = (static_cast<long double>(box.min[i]) - origin[i]) / d;
    const long double b = (static_cast<long double>(box.max[i]) - origin[i]) / d;
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  return near <= far;
}

// A third of the directions has zero components, a third of the origins lies on a box's corner.
TEST(Bvh, NoBoxOnTheWayIsMissed) {
  Random random(3);
  const std::vector<Box3> boxes = RandomBoxes(random, 300);
  const Bvh bvh(boxes);
  size_t met = 0, visited = 0;
  for (int k = 0; k < 5000; ++k) {
    Vec3d origin = random.InCube(12);
    if (random.Below(3) == 0) origin = boxes[static_cast<size_t>(random.Below(300))].min;
    Vec3d direction = random.Direction();
    if (random.Below(3) == 0) direction[random.Below(3)] = random.Below(2) == 0 ? 0.0 : -0.0;
    const double t_max = random.Below(2) == 0 ? Box3::kInf : random.Uniform(0, 10);
    std::set<int> found;
    const Bvh::Visits visits = bvh.ForEachAlong(origin, direction, t_max, [&](int object) {
      found.insert(object);
      return true;
    });
    EXPECT_EQ(visits.objects, found.size());
    visited += visits.objects;
    for (size_t i = 0; i < boxes.size(); ++i) {
      if (!Meets(boxes[i], origin, direction, t_max)) continue;
      ++met;
      EXPECT_TRUE(found.contains(static_cast<int>(i))) << "ray " << k << " box " << i;
    }
  }
  EXPECT_GT(met, 1500u);
  EXPECT_LT(visited, 5000u * 300u / 4) << "the hierarchy prunes next to nothing";
}

// A ray in the plane of a (widened) box side: 0 * inf, which must not turn into a miss.
TEST(RaySlabs, RaysInABoxsPlaneMeetIt) {
  constexpr double kUnitPad = 1 / RaySlabs<double>::kPad;  // the magnitude that makes the pad 1
  const double t_max = Box3::kInf;
  for (const double zero : {0.0, -0.0}) {
    const RaySlabs<double> slabs(Vec3d{0, 0, 0}, Vec3d{zero, 0.5, 1}, kUnitPad);
    double entry = 0;
    EXPECT_TRUE(slabs.Meets({{1, -9, 3}, {2, 9, 4}}, t_max, entry));
    EXPECT_EQ(entry, 2) << "one pad nearer";
    EXPECT_TRUE(slabs.Meets({{-2, -9, 3}, {-1, 9, 4}}, t_max, entry));
    EXPECT_FALSE(slabs.Meets({{1.5, -9, 3}, {2, 9, 4}}, t_max, entry));
    EXPECT_FALSE(slabs.Meets({{1, -9, 3}, {2, 9, 4}}, 1.5, entry)) << "behind the limit";
    EXPECT_FALSE(slabs.Meets({{1, -9, -4}, {2, 9, -3}}, t_max, entry)) << "behind the origin";
  }
}

TEST(Bvh, LoweringTheLimitPrunesWhatLiesBehind) {
  std::vector<Box3> boxes;
  for (int i = 0; i < 1024; ++i) boxes.push_back({{i + 0.1, -1, -1}, {i + 0.9, 1, 1}});
  const Bvh bvh(boxes);
  double nearest = Box3::kInf;
  const Bvh::Visits visits =
      bvh.ForEachAlong(Vec3d{-1, 0, 0}, Vec3d{1, 0, 0}, nearest, [&](int object) {
        nearest = std::min(nearest, object + 1.1);
        return true;
      });
  EXPECT_EQ(nearest, 1.1);
  EXPECT_LE(visits.objects, 4u);
}

TEST(Bvh, StopsWhenTold) {
  Random random(4);
  const std::vector<Box3> boxes(100, Box3{{-1, -1, -1}, {1, 1, 1}});
  const Bvh bvh(boxes);
  const double t_max = Box3::kInf;
  const auto stop = [](int) { return false; };
  EXPECT_EQ(bvh.ForEachAlong(Vec3d{-5, 0, 0}, Vec3d{1, 0, 0}, t_max, stop).objects, 1u);
  EXPECT_EQ(bvh.ForEachOverlap([](const Box3&) { return true; }, stop).objects, 1u);
  EXPECT_EQ(bvh.ForEachOverlap([](const Box3&) { return false; }, stop).objects, 0u);
}

TEST(Bvh, BytesAreCounted) {
  Random random(5);
  const std::vector<Box3> boxes = RandomBoxes(random, 100);
  const Bvh bvh(boxes);
  EXPECT_GE(bvh.ByteSize(), bvh.nodes().size() * sizeof(Bvh::Node) + 100 * sizeof(int32_t));
}

}  // namespace
}  // namespace linetree
