// Where the answers of a block's pixels came from: from what its workspace noted (PixelUse) to the
// frame's sources, verdicts and counters.
#pragma once

#include <array>
#include <cstdint>

#include "core/packet/packet_tracer.h"
#include "core/render/frame.h"

namespace linetree {

// Pixels by PixelUse.
struct UseCounts {
  std::array<uint64_t, kPixelUses> of{};

  UseCounts& operator+=(const UseCounts& o) {
    for (size_t use = 0; use < of.size(); ++use) of[use] += o.of[use];
    return *this;
  }
};

// Stores the sources and verdicts of those of the block's tiles, row by row, whose bit is set.
// `uses`: kPacketLanes for every tile. `asked`: whether trees were asked; if not, whatever hits
// something is traced.
void StoreSources(const PacketTracer::Region& block, uint64_t tiles, const uint8_t* uses,
                  bool asked, Frame& frame, UseCounts& counts);

// The same of pixels that were evaluated once for `each` samples: those of the block's tiles that
// are `done`.
void StoreOnce(const PacketTracer::Region& block, const LaneMask* done, const uint8_t* uses,
               uint64_t each, Frame& frame, UseCounts& counts);

// Adds pixels to the frame's counters.
void AddSources(const UseCounts& counts, bool asked, FrameStats& stats);

}  // namespace linetree
