#include "core/render/tile_sources.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/random.h"

namespace linetree {
namespace {

constexpr int kWidth = 101, kHeight = 77;
constexpr auto kUntouched = static_cast<Source>(99);

Frame UntouchedFrame() {
  Frame frame;
  frame.width = kWidth;
  frame.height = kHeight;
  frame.source.assign(kWidth * kHeight, kUntouched);
  frame.verdict.assign(kWidth * kHeight, Verdict::kUntried);
  return frame;
}

// What frame.h says of each, word by word.
Source SourceOf(int use, bool asked) {
  const bool searched = (use & kSearched) != 0, spared = (use & kListed) != 0;
  if ((use & kMissed) != 0) return Source::kBackground;
  if (!asked || (searched && !spared)) return Source::kTraced;
  if (searched) return Source::kResidual;
  return (use & kSummed) != 0 ? Source::kInterpolated : Source::kReplayed;
}

// Uses of the tiles of a block; in one of two all pixels of a tile have the same.
std::vector<uint8_t> RandomUses(test::Random& random) {
  std::vector<uint8_t> uses(kBlockPixels);
  for (size_t tile = 0; tile < uses.size(); tile += kPacketLanes) {
    const bool alike = random.Below(2) == 0;
    const int first = random.Below(kPixelUses);
    for (size_t lane = 0; lane < kPacketLanes; ++lane) {
      uses[tile + lane] = static_cast<uint8_t>(alike ? first : random.Below(kPixelUses));
    }
    // The last lane alone is different, or those outside a partial tile.
    if (random.Below(4) == 0) uses[tile + kPacketLanes - 1] ^= 1;
  }
  return uses;
}

// Blocks whole and partial, in the corner of a frame and elsewhere.
PacketTracer::Region RandomBlock(test::Random& random) {
  const int width = random.Below(3) == 0 ? kBlockSide : random.Int(1, kBlockSide);
  const int height = random.Below(3) == 0 ? kBlockSide : random.Int(1, kBlockSide);
  const bool last = random.Below(2) == 0;
  return {last ? kWidth - width : random.Below(kWidth - width + 1),
          last ? kHeight - height : random.Below(kHeight - height + 1), width, height};
}

bool IsIn(const PacketTracer::Region& block, int x, int y) {
  return x >= block.column && x < block.column + block.width && y >= block.row &&
         y < block.row + block.height;
}

// Compares every pixel of the frame, and adds those of the block's wanted tiles to `uses_of`.
void ExpectSources(const PacketTracer::Region& block, uint64_t tiles,
                   const std::vector<uint8_t>& uses, bool asked, const Frame& frame,
                   UseCounts& uses_of) {
  const int across = (block.width + 3) / 4;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto p = static_cast<size_t>(y * kWidth + x);
      const int i = x - block.column, j = y - block.row;
      const int tile = j / 4 * across + i / 4;
      if (!IsIn(block, x, y) || (tiles >> tile & 1) == 0) {
        ASSERT_EQ(frame.source[p], kUntouched) << x << ", " << y;
        continue;
      }
      const int use = uses[static_cast<size_t>(tile * kPacketLanes + j % 4 * 4 + i % 4)];
      ++uses_of.of[static_cast<size_t>(use)];
      ASSERT_EQ(frame.source[p], SourceOf(use, asked)) << x << ", " << y;
      const bool certified = frame.source[p] == Source::kInterpolated;
      ASSERT_EQ(frame.verdict[p], certified ? Verdict::kCertified : Verdict::kUntried);
    }
  }
}

TEST(TileSourcesTest, EveryPixelOfTheWantedTilesAndNoOther) {
  for (uint64_t seed = 0; seed < 200; ++seed) {
    test::Random random(seed);
    const PacketTracer::Region block = RandomBlock(random);
    const std::vector<uint8_t> uses = RandomUses(random);
    const uint64_t tiles =
        seed % 3 == 0 ? ~uint64_t{0} : static_cast<uint64_t>(random.Unit() * 0x1p63);
    for (const bool asked : {false, true}) {
      Frame frame = UntouchedFrame();
      UseCounts counts, expected;
      StoreSources(block, tiles, uses.data(), asked, frame, counts);
      ExpectSources(block, tiles, uses, asked, frame, expected);
      if (HasFatalFailure()) return;
      ASSERT_EQ(counts.of, expected.of) << "seed " << seed;
    }
  }
}

TEST(TileSourcesTest, CountersAddUpToWhatTheFrameSays) {
  for (uint64_t seed = 0; seed < 40; ++seed) {
    test::Random random(seed);
    const bool asked = seed % 2 == 0;
    Frame frame = UntouchedFrame();
    FrameStats& stats = frame.stats;
    // Two waves over one block: what the first leaves is the second's.
    const PacketTracer::Region block = RandomBlock(random);
    const uint64_t first = 0x123456789abcdef0 * (seed + 1);
    for (const uint64_t tiles : {first, ~first}) {
      UseCounts counts;
      StoreSources(block, tiles, RandomUses(random).data(), asked, frame, counts);
      AddSources(counts, asked, stats);
    }
    const auto tally = [&](Source source) {
      return static_cast<uint64_t>(std::count(frame.source.begin(), frame.source.end(), source));
    };
    ASSERT_EQ(stats.pixels, static_cast<uint64_t>(block.width * block.height));
    ASSERT_EQ(stats.interpolated + stats.traced + stats.background, stats.pixels);
    ASSERT_EQ(stats.interpolated, tally(Source::kInterpolated));
    ASSERT_EQ(stats.background, tally(Source::kBackground));
    ASSERT_EQ(stats.replayed, tally(Source::kReplayed));
    ASSERT_EQ(stats.residual, tally(Source::kResidual));
    ASSERT_EQ(stats.traced - stats.replayed - stats.residual, tally(Source::kTraced));
    ASSERT_EQ(stats.verdicts[static_cast<size_t>(Verdict::kCertified)], stats.interpolated);
    ASSERT_EQ(stats.verdicts[static_cast<size_t>(Verdict::kUntried)],
              stats.pixels - stats.interpolated);
    ASSERT_EQ(stats.interpolated + stats.replayed + stats.residual > 0, asked) << "seed " << seed;
  }
}

}  // namespace
}  // namespace linetree
