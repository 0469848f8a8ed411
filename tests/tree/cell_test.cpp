#include "core/tree/cell.h"

#include <gtest/gtest.h>

#include "tests/support/random.h"

namespace linetree {
namespace {

TEST(CellTest, CellHoldsItsCoordinatesAtEveryDepth) {
  test::Random random(1);
  for (int i = 0; i < 20000; ++i) {
    const RayCoords x{random.Uniform(0, 1), random.Uniform(0, 1), random.Uniform(0, 1),
                      random.Uniform(0, 1)};
    const int depth = random.Int(0, kMaxCellDepth);
    const CellId cell = CellAt(x, depth);
    const RayCoords lo = CoordsOfGrid(cell.Corner(0)), hi = CoordsOfGrid(cell.Corner(15));
    for (size_t k = 0; k < 4; ++k) {
      ASSERT_LE(lo[k], x[k]);
      ASSERT_GE(hi[k], x[k]);
      ASSERT_EQ(hi[k] - lo[k], std::ldexp(1.0, -depth));
    }
  }
}

TEST(CellTest, UpperFacesBelongToTheLastCell) {
  const CellId cell = CellAt({1, 1, 1, 1}, 5);
  EXPECT_EQ(cell.index, (std::array<uint16_t, 4>{31, 31, 31, 31}));
}

TEST(CellTest, ChildrenAreWhereTheWalkGoes) {
  test::Random random(2);
  for (int i = 0; i < 5000; ++i) {
    const RayCoords x{random.Uniform(0, 1), random.Uniform(0, 1), random.Uniform(0, 1),
                      random.Uniform(0, 1)};
    const CellId deep = CellAt(x, 9);
    CellId walk;
    for (int level = 0; level < 9; ++level) walk = walk.Child(deep.ChildAt(level));
    ASSERT_EQ(walk, deep);
  }
}

TEST(CellTest, NeighboursAndGenerationsShareCorners) {
  CellId left;
  left.depth = 3;
  left.index = {2, 1, 0, 5};
  CellId right = left;
  right.index[0] = 3;
  EXPECT_EQ(left.Corner(1), right.Corner(0));
  EXPECT_EQ(left.Corner(15), right.Corner(14));
  for (int c = 0; c < kCellCorners; ++c) EXPECT_EQ(left.Corner(c), left.Child(c).Corner(c));
}

TEST(CellTest, GridKeysAreDistinct) {
  const GridPoint a{1, 2, 3, 4}, b{2, 1, 3, 4}, c{32768, 32768, 32768, 32768};
  EXPECT_NE(GridKey(a), GridKey(b));
  EXPECT_NE(GridKey(a), GridKey(c));
  EXPECT_EQ(CoordsOfGrid(c), (RayCoords{1, 1, 1, 1}));
}

}  // namespace
}  // namespace linetree
