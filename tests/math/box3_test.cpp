#include "core/math/box3.h"

#include <gtest/gtest.h>

namespace linetree {
namespace {

TEST(Box3, StartsEmptyAndGrows) {
  Box3 box;
  EXPECT_TRUE(box.IsEmpty());
  EXPECT_EQ(box.HalfArea(), 0);
  EXPECT_FALSE(box.Contains({0, 0, 0}));
  box.Add(Vec3d{1, 2, 3});
  EXPECT_FALSE(box.IsEmpty());
  EXPECT_EQ(box.Extent(), (Vec3d{0, 0, 0}));
  box.Add(Box3{{-1, 0, 0}, {0, 5, 1}});
  EXPECT_EQ(box, (Box3{{-1, 0, 0}, {1, 5, 3}}));
  EXPECT_EQ(box.Center(), (Vec3d{0, 2.5, 1.5}));
  EXPECT_EQ(box.HalfArea(), 2 * 5 + 5 * 3 + 3 * 2);
  Box3 same = box;
  same.Add(Box3{});
  EXPECT_EQ(same, box) << "the empty box adds nothing";
}

TEST(Box3, BoundariesBelongToIt) {
  const Box3 box{{0, 0, 0}, {1, 2, 3}};
  EXPECT_TRUE(box.Contains({0, 0, 0}));
  EXPECT_TRUE(box.Contains({1, 2, 3}));
  EXPECT_FALSE(box.Contains({1.1, 1, 1}));
  EXPECT_TRUE(box.Overlaps({{1, 2, 3}, {4, 4, 4}}));
  for (int i = 0; i < 3; ++i) {
    Box3 beside = box;
    beside.min[i] = box.max[i] + 0.5;
    beside.max[i] = box.max[i] + 1;
    EXPECT_FALSE(box.Overlaps(beside));
    EXPECT_FALSE(beside.Overlaps(box));
  }
}

}  // namespace
}  // namespace linetree
