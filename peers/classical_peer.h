// The project's own classical tracer (scalar, double), as a frame of core/render in classical mode.
#pragma once

#include "peers/peer.h"

namespace linetree {

absl::StatusOr<std::unique_ptr<Peer>> MakeClassicalPeer(const PeerSetup& setup);

}  // namespace linetree
