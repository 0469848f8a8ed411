// Tachyon, as the program `tachyon`.
#pragma once

#include "peers/peer.h"

namespace linetree {

absl::StatusOr<std::unique_ptr<Peer>> MakeTachyonPeer(const PeerSetup& setup);

}  // namespace linetree
