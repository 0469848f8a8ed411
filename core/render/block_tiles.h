// Which blocks of a frame, and which of their tiles (4 x 4 pixels), are looked at first. As bits,
// row by row: those of BlockTask::tiles.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/packet/packet_workspace.h"

namespace linetree {

inline constexpr size_t kTilesOfBlock = kBlockPixels / kPacketLanes;
inline constexpr size_t kTilesInRow = 8;
inline constexpr uint64_t kAllTiles = ~uint64_t{0};
static_assert(kTilesOfBlock == 64 && kTilesInRow * kTilesInRow == kTilesOfBlock);

// One in so many blocks of a frame is probed: in small frames more of them, so that objects and
// cells that are seen in few pixels are met as well.
inline constexpr size_t kMostApart = 16, kLeastApart = 4, kFewProbed = 16;
inline size_t OneProbedIn(size_t blocks) {
  return std::clamp(blocks / kFewProbed, kLeastApart, kMostApart);
}
// Of a probed block so many tiles are booked.
inline constexpr size_t kBookedTiles = 4;

// Whether the block is one of those, in a frame of so many blocks `across`: scattered, every turn
// others, but two beside each other, for blocks far apart share no page of the frame.
inline bool IsProbed(size_t block, size_t across, size_t one_in, size_t turn) {
  constexpr size_t kRun = 2;
  return (block % across / kRun + block / across * 3 + turn) % one_in == 0;
}

// One tile in every quadrant: scattered, so that no pattern of the picture can hide from them.
inline uint64_t TilesToBook(size_t block) {
  constexpr size_t kHalf = kTilesInRow / 2;
  uint64_t tiles = 0;
  for (size_t q = 0; q < kBookedTiles; ++q) {
    const size_t in = (block * 29 + q * 7) % (kHalf * kHalf);
    const size_t row = q / 2 * kHalf + in / kHalf, column = q % 2 * kHalf + in % kHalf;
    tiles |= uint64_t{1} << (row * kTilesInRow + column);
  }
  return tiles;
}

// A square of so many tiles a side, to see where cells are missing: rays that stay together are
// traced faster.
inline constexpr size_t kTriedSide = 4;
inline constexpr double kTriedShare = static_cast<double>(kTriedSide * kTriedSide) / kTilesOfBlock;
inline uint64_t TriedSquare(size_t block) {
  constexpr size_t kSquares = kTilesInRow / kTriedSide;
  const size_t square = block * 11 % (kSquares * kSquares);
  const size_t corner =
      square / kSquares * kTriedSide * kTilesInRow + square % kSquares * kTriedSide;
  uint64_t tiles = 0;
  for (size_t row = 0; row < kTriedSide; ++row) {
    tiles |= ((uint64_t{1} << kTriedSide) - 1) << (corner + row * kTilesInRow);
  }
  return tiles;
}

}  // namespace linetree
