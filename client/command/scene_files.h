// The scene files of a folder.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace linetree {

// All scenes of the folder and of spd/ in it, in the order of their names. NOT_FOUND where there
// are none.
absl::StatusOr<std::vector<std::string>> ScenesIn(const std::string& folder);

// Hash of what a file holds, as hexadecimal digits; "" for one that cannot be read.
std::string HashOfFile(const std::string& path);

}  // namespace linetree
