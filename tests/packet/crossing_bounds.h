// What the search in float says of where sixteen lines cross one shape (core/packet/shapes-inl.h).
#pragma once

#include <array>

#include "core/packet/packet.h"
#include "core/packet/packet_scene.h"

namespace linetree::test {

struct CrossingBounds {
  LaneMask maybe = 0, sure = 0;
  alignas(64) std::array<float, kPacketLanes> low{};
  alignas(64) std::array<float, kPacketLanes> high{};
};

// The first and the second crossing of each line, on the chosen target of Highway. False where that
// target has no search in float.
bool FindCrossingBounds(const PacketScene& scene, int shape, const PacketRays& rays,
                        std::array<CrossingBounds, 2>& bounds);

// Where lines come nearest to a ball's centre, as the search in float has it: the parameter and the
// way from the centre to there; and the sum of lengths R of margins.h.
struct NearestPoints {
  alignas(64) std::array<float, kPacketLanes> t{};
  alignas(64) std::array<float, kPacketLanes> x{};
  alignas(64) std::array<float, kPacketLanes> y{};
  alignas(64) std::array<float, kPacketLanes> z{};
  float size = 0;
};
// Of rays, and of shadow rays from hits to the scene's first light. False as above.
bool FindNearestPoints(const PacketScene& scene, int ball, const PacketRays& rays,
                       NearestPoints& nearest);
bool FindNearestPoints(const PacketScene& scene, int ball, const PacketHits& hits,
                       NearestPoints& nearest);

}  // namespace linetree::test
