#include "core/render/tile_sources.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace linetree {
namespace {

constexpr int kTileSide = 4;

struct Answer {
  Source source = Source::kTraced;
  Verdict verdict = Verdict::kUntried;
};

constexpr Answer AnswerOf(size_t use, bool asked) {
  if ((use & kMissed) != 0) return {Source::kBackground, Verdict::kUntried};
  if (!asked) return {};
  if ((use & kSearched) == 0) {
    return (use & kSummed) != 0 ? Answer{Source::kInterpolated, Verdict::kCertified}
                                : Answer{Source::kReplayed, Verdict::kUntried};
  }
  return (use & kListed) != 0 ? Answer{Source::kResidual, Verdict::kUntried} : Answer{};
}

// By use.
struct AnswerTable {
  Source source[kPixelUses];
  Verdict verdict[kPixelUses];
};
constexpr AnswerTable TableOf(bool asked) {
  AnswerTable table{};
  for (size_t use = 0; use < kPixelUses; ++use) {
    const Answer answer = AnswerOf(use, asked);
    table.source[use] = answer.source;
    table.verdict[use] = answer.verdict;
  }
  return table;
}
constexpr AnswerTable kTables[] = {TableOf(false), TableOf(true)};

// Where one tile's pixels lie in the frame.
struct TilePixels {
  size_t first;  // top left
  size_t stride;
  int columns, rows;
};

void StorePartial(const TilePixels& at, const uint8_t* uses, const AnswerTable& table, Frame& frame,
                  UseCounts& counts) {
  for (int y = 0; y < at.rows; ++y) {
    for (int x = 0; x < at.columns; ++x) {
      const uint8_t use = uses[y * kTileSide + x];
      ++counts.of[use];
      const size_t p = at.first + static_cast<size_t>(y) * at.stride + static_cast<size_t>(x);
      frame.source[p] = table.source[use];
      frame.verdict[p] = table.verdict[use];
    }
  }
}

void StoreWhole(const TilePixels& at, const uint8_t* uses, const AnswerTable& table, Frame& frame,
                UseCounts& counts) {
  Source source[kPacketLanes];
  Verdict verdict[kPacketLanes];
  if (std::memcmp(uses, uses + 1, kPacketLanes - 1) == 0) {
    counts.of[uses[0]] += kPacketLanes;
    std::fill_n(source, kPacketLanes, table.source[uses[0]]);
    std::fill_n(verdict, kPacketLanes, table.verdict[uses[0]]);
  } else {
    for (size_t lane = 0; lane < kPacketLanes; ++lane) {
      ++counts.of[uses[lane]];
      source[lane] = table.source[uses[lane]];
      verdict[lane] = table.verdict[uses[lane]];
    }
  }
  for (size_t y = 0; y < kTileSide; ++y) {
    std::memcpy(frame.source.data() + at.first + y * at.stride, source + y * kTileSide, kTileSide);
    std::memcpy(frame.verdict.data() + at.first + y * at.stride, verdict + y * kTileSide,
                kTileSide);
  }
}

}  // namespace

void StoreSources(const PacketTracer::Region& block, uint64_t tiles, const uint8_t* uses,
                  bool asked, Frame& frame, UseCounts& counts) {
  static_assert(sizeof(Source) == 1 && sizeof(Verdict) == 1);
  const auto stride = static_cast<size_t>(frame.width);
  const AnswerTable& table = kTables[asked ? 1 : 0];
  const int across = (block.width + kTileSide - 1) / kTileSide;
  const int down = (block.height + kTileSide - 1) / kTileSide;
  for (int tile = 0; tile < across * down; ++tile) {
    if ((tiles >> tile & 1) == 0) continue;
    const int column = tile % across * kTileSide, row = tile / across * kTileSide;
    const TilePixels at = {
        static_cast<size_t>(block.row + row) * stride + static_cast<size_t>(block.column + column),
        stride, std::min(kTileSide, block.width - column), std::min(kTileSide, block.height - row)};
    const uint8_t* own = uses + tile * kPacketLanes;
    const bool whole = at.columns == kTileSide && at.rows == kTileSide;
    (whole ? StoreWhole : StorePartial)(at, own, table, frame, counts);
  }
}

void StoreOnce(const PacketTracer::Region& block, const LaneMask* done, const uint8_t* uses,
               uint64_t each, Frame& frame, UseCounts& counts) {
  const auto stride = static_cast<size_t>(frame.width);
  const int across = (block.width + kTileSide - 1) / kTileSide;
  const int down = (block.height + kTileSide - 1) / kTileSide;
  for (int tile = 0; tile < across * down; ++tile) {
    for (LaneMask left = done[tile]; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const auto use = static_cast<size_t>(uses[tile * kPacketLanes + lane]);
      counts.of[use] += each;
      const Answer answer = AnswerOf(use, true);
      const int column = block.column + tile % across * kTileSide + lane % kTileSide;
      const int row = block.row + tile / across * kTileSide + lane / kTileSide;
      const size_t p = static_cast<size_t>(row) * stride + static_cast<size_t>(column);
      frame.source[p] = answer.source;
      frame.verdict[p] = answer.verdict;
    }
  }
}

void AddSources(const UseCounts& counts, bool asked, FrameStats& stats) {
  for (size_t use = 0; use < counts.of.size(); ++use) {
    const uint64_t pixels = counts.of[use];
    const Answer answer = AnswerOf(use, asked);
    stats.pixels += pixels;
    switch (answer.source) {
      case Source::kBackground:
        stats.background += pixels;
        break;
      case Source::kInterpolated:
        stats.interpolated += pixels;
        break;
      case Source::kTraced:
        stats.traced += pixels;
        break;
      case Source::kReplayed:
        stats.traced += pixels;
        stats.replayed += pixels;
        break;
      case Source::kResidual:
        stats.traced += pixels;
        stats.residual += pixels;
        break;
    }
    stats.verdicts[static_cast<size_t>(answer.verdict)] += pixels;
  }
}

}  // namespace linetree
