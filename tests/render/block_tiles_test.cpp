#include "core/render/block_tiles.h"

#include <gtest/gtest.h>

#include <bit>

namespace linetree {
namespace {

constexpr uint64_t kTopLeft = 0x0f0f0f0f;  // a quadrant

TEST(BlockTilesTest, EveryQuadrantIsBookedOnceAndNotAlwaysAtTheSamePlace) {
  uint64_t anywhere = 0;
  for (size_t block = 0; block < 100; ++block) {
    const uint64_t tiles = TilesToBook(block);
    for (const int shift : {0, 4, 32, 36}) {
      EXPECT_EQ(std::popcount(tiles & kTopLeft << shift), 1) << block;
    }
    anywhere |= tiles;
  }
  EXPECT_EQ(anywhere, kAllTiles);
}

TEST(BlockTilesTest, TriedSquaresAreQuadrantsAndAllOfThemComeUp) {
  uint64_t anywhere = 0;
  for (size_t block = 0; block < 8; ++block) {
    const uint64_t tiles = TriedSquare(block);
    EXPECT_EQ(tiles, kTopLeft << std::countr_zero(tiles)) << block;
    anywhere |= tiles;
  }
  EXPECT_EQ(anywhere, kAllTiles);
}

// As many as they are said to be, and within so many turns every block.
TEST(BlockTilesTest, ProbedBlocksAreTheShareThatTheyStandFor) {
  for (const auto& [across, down] : {std::pair<size_t, size_t>{16, 16}, {7, 7}, {60, 34}}) {
    const size_t one_in = OneProbedIn(across * down);
    size_t probed = 0, others = 0;
    for (size_t turn = 0; turn < one_in; ++turn) {
      size_t now = 0;
      for (size_t block = 0; block < across * down; ++block) {
        now += IsProbed(block, across, one_in, turn) ? 1 : 0;
      }
      probed += now;
      others += now == 0 ? 1 : 0;
    }
    EXPECT_EQ(probed, across * down) << "each once";
    EXPECT_LT(others, one_in / 4);
    EXPECT_GE(across * down / one_in, std::min(across * down / kLeastApart, kFewProbed));
  }
}

}  // namespace
}  // namespace linetree
