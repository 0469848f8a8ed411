// The Whitted tracer on Embree (peers/embree), one ray at a time; UNAVAILABLE in builds without
// Embree.
#pragma once

#include "peers/peer.h"

namespace linetree {

absl::StatusOr<std::unique_ptr<Peer>> MakeEmbreePeer(const PeerSetup& setup);

}  // namespace linetree
