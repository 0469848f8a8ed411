// POV-Ray, as the program `povray`.
#pragma once

#include "peers/peer.h"

namespace linetree {

absl::StatusOr<std::unique_ptr<Peer>> MakePovPeer(const PeerSetup& setup);

}  // namespace linetree
