// Packets that were booked in the plan, kept until the trees have grown: what they would cost then
// is counted without tracing anything again.
#pragma once

#include <cstdint>
#include <vector>

#include "core/packet/packet.h"

namespace linetree {

struct BookedPacket {
  PacketHits hits;
  LaneMask lanes = 0;      // of which the lights are asked for
  LaneMask active = 0;     // that are rays at all
  bool is_tile = false;    // as PathPacket::is_tile
  uint32_t classical = 0;  // work of all lights without trees,
  uint32_t search = 0;     // of it, what one light's search took
};

// Which packets of a block of pixels are booked, and those that were.
struct BookedPackets {
  uint64_t tiles = 0;   // those of eye rays, as BlockTask::tiles,
  uint32_t one_in = 1;  // and of those that they spawn one in so many
  // Whether the block's other packets count among those that use cells: not where one that is
  // booked is to stand for many.
  bool others_count = false;
  std::vector<BookedPacket> packets{};
};

}  // namespace linetree
