// What `linetree bench peers` prints and writes.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "peers/peer_study.h"

namespace linetree {

struct ScenePeers {
  std::string scene;
  int width = 0, height = 0;
  std::vector<PeerRow> rows;
};

// A row for every peer that has a picture.
std::string PeersTable(const ScenePeers& scene);

// A line for each peer without a picture, and one for each thing that a picture shows otherwise.
std::string PeersNotes(const ScenePeers& scene);

nlohmann::json PeersJson(const std::vector<ScenePeers>& scenes, int repeats);

}  // namespace linetree
