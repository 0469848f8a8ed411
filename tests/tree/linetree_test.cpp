#include "core/tree/linetree.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "tests/support/random.h"

namespace linetree {
namespace {

constexpr RayCoords kPoint{0.3, 0.6, 0.1, 0.9};

Judgement Certified(double spread, float value) {
  Judgement j;
  j.verdict = Verdict::kCertified;
  j.spread = spread;
  for (auto& corner : j.interpolant.corner) corner.fill(value);
  return j;
}
Judgement Refused(Verdict verdict) {
  Judgement j;
  j.verdict = verdict;
  return j;
}

TEST(LinetreeTest, AsksForOneLevelAfterTheOther) {
  CellPools pools;
  Linetree tree(pools);
  for (int depth = 0; depth <= 3; ++depth) {
    const Lookup found = tree.Find(kPoint, 0.1, 3, 1);
    ASSERT_EQ(found.kind, Lookup::Kind::kUnbuilt);
    ASSERT_EQ(found.cell, CellAt(kPoint, depth));
    EXPECT_EQ(found.verdict, depth == 0 ? Verdict::kUntried : Verdict::kGap);
    EXPECT_TRUE(tree.Publish(found.cell, Refused(Verdict::kGap), 1));
  }
  EXPECT_EQ(tree.Find(kPoint, 0.1, 3, 1).kind, Lookup::Kind::kGiveUp);
  EXPECT_EQ(tree.cell_count(), 4u);
  EXPECT_EQ(tree.verdicts()[static_cast<size_t>(Verdict::kGap)], 4u);
}

TEST(LinetreeTest, OneTreeServesEveryEpsilon) {
  CellPools pools;
  Linetree tree(pools);
  tree.Publish(CellAt(kPoint, 0), Certified(0.3, 1), 1);
  tree.Publish(CellAt(kPoint, 1), Certified(0.05, 2), 1);
  const Lookup loose = tree.Find(kPoint, 0.5, 3, 1), strict = tree.Find(kPoint, 0.1, 3, 1);
  ASSERT_EQ(loose.kind, Lookup::Kind::kAnswer);
  EXPECT_EQ(loose.interpolant->corner[0][0], 1);
  ASSERT_EQ(strict.kind, Lookup::Kind::kAnswer);
  EXPECT_EQ(strict.interpolant->corner[0][0], 2);
  const Lookup stricter = tree.Find(kPoint, 0.01, 3, 1);
  EXPECT_EQ(stricter.kind, Lookup::Kind::kUnbuilt);
  EXPECT_EQ(stricter.verdict, Verdict::kEpsilon);
}

TEST(LinetreeTest, ASpreadJustAboveEpsilonDoesNotAnswer) {
  CellPools pools;
  Linetree tree(pools);
  const double epsilon = 0.1;
  tree.Publish(CellId{}, Certified(std::nextafter(epsilon, 1), 1), 1);
  EXPECT_NE(tree.Find(kPoint, epsilon, 0, 1).kind, Lookup::Kind::kAnswer);
}

TEST(LinetreeTest, ACellIsPublishedOnce) {
  CellPools pools;
  Linetree tree(pools);
  EXPECT_TRUE(tree.Publish(CellId{}, Certified(0.1, 1), 1));
  EXPECT_FALSE(tree.Publish(CellId{}, Certified(0.1, 2), 1));
  EXPECT_FALSE(tree.Publish(CellAt(kPoint, 2), Refused(Verdict::kGap), 1)) << "its parent is gone";
  EXPECT_EQ(tree.cell_count(), 1u);
}

// What is left behind by a cell that comes too late would never be a leaf.
TEST(LinetreeTest, ACellWhoseParentsAreGoneLeavesNothingBehind) {
  CellPools pools;
  Linetree tree(pools);
  tree.Publish(CellId{}, Refused(Verdict::kGap), 1);
  EXPECT_FALSE(tree.Publish(CellAt(kPoint, 2), Refused(Verdict::kGap), 1));
  EXPECT_EQ(pools.ByteSize(), 0u);
  RetiredCells retired;
  tree.ForEachLeaf([&](CellHandle leaf, uint32_t) { tree.EvictLeaf(leaf, retired); });
  EXPECT_EQ(tree.cell_count(), 0u);
}

TEST(LinetreeTest, LeavesGoBeforeParentsAndBytesAddUp) {
  CellPools pools;
  Linetree tree(pools);
  test::Random random(20);
  for (int i = 0; i < 3000; ++i) {
    const RayCoords x{random.Uniform(0, 1), random.Uniform(0, 1), random.Uniform(0, 1),
                      random.Uniform(0, 1)};
    const Lookup found = tree.Find(x, 0.1, 4, static_cast<uint32_t>(i));
    if (found.kind != Lookup::Kind::kUnbuilt) continue;
    const bool certify = random.Int(0, 1) != 0;
    tree.Publish(found.cell, certify ? Certified(1, 1) : Refused(Verdict::kBlocker),
                 static_cast<uint32_t>(i));
  }
  ASSERT_EQ(pools.ByteSize(), tree.CountBytes());
  ASSERT_GT(tree.cell_count(), 1000u);
  while (tree.cell_count() > 0) {
    std::vector<CellHandle> leaves;
    tree.ForEachLeaf([&](CellHandle leaf, uint32_t) { leaves.push_back(leaf); });
    ASSERT_FALSE(leaves.empty());
    const uint64_t before = pools.ByteSize();
    RetiredCells retired;
    for (const CellHandle& leaf : leaves) tree.EvictLeaf(leaf, retired);
    ASSERT_EQ(pools.ByteSize(), before) << "somebody may still read them";
    pools.Free(retired);
    ASSERT_EQ(pools.ByteSize(), before - retired.ByteSize());
    ASSERT_EQ(pools.ByteSize(), tree.CountBytes());
  }
  EXPECT_EQ(pools.ByteSize(), 0u);
  EXPECT_EQ(tree.Find(kPoint, 0.1, 4, 1).cell, CellId{});
}

TEST(LinetreeTest, FindMarksWhatItUses) {
  CellPools pools;
  Linetree tree(pools);
  tree.Publish(CellId{}, Certified(0.01, 1), 5);
  tree.Find(kPoint, 0.1, 4, 9);
  uint32_t used = 0;
  tree.ForEachLeaf([&](CellHandle, uint32_t last_used) { used = last_used; });
  EXPECT_EQ(used, 9u);
}

TEST(LinetreeTest, ClearGivesEverythingBack) {
  CellPools pools;
  Linetree a(pools), b(pools);
  for (Linetree* tree : {&a, &b}) {
    for (int depth = 0; depth < 5; ++depth) {
      tree->Publish(CellAt(kPoint, depth), Certified(1, 1), 1);
    }
  }
  const uint64_t both = pools.ByteSize();
  a.Clear();
  EXPECT_EQ(pools.ByteSize(), both / 2);
  EXPECT_EQ(b.cell_count(), 5u);
  EXPECT_EQ(a.cell_count(), 0u);
}

}  // namespace
}  // namespace linetree
