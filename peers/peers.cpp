#include "peers/classical_peer.h"
#include "peers/embree_peer.h"
#include "peers/peer.h"
#include "peers/pov_peer.h"
#include "peers/tachyon_peer.h"

namespace linetree {

std::vector<PeerKind> AllPeers() {
  return {{"classical", MakeClassicalPeer},
          {"embree", MakeEmbreePeer},
          {"povray", MakePovPeer},
          {"tachyon", MakeTachyonPeer}};
}

}  // namespace linetree
