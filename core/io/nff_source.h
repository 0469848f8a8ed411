// A scene that was read from NFF, with the records that its elements came from.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "core/io/load_scene.h"
#include "core/io/nff_tokens.h"

namespace linetree {

// By repeated field of v1::Scene ("objects"): the position of the record behind each element.
using NffPositions = absl::flat_hash_map<std::string, std::vector<TextPosition>>;

// `Where` answers with the record: "objects[3].sphere.radius" is at its `s`.
std::unique_ptr<SceneSource> MakeNffSource(v1::Scene message, NffPositions positions,
                                           std::string file_name);

}  // namespace linetree
