// Values on the command line that are more than one number or word.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/math/vec3.h"

namespace linetree {

// "x,y,z": three finite numbers.
absl::StatusOr<Vec3d> ParseVec3(const std::string& text);

// "a,b,c": one or more finite numbers.
absl::StatusOr<std::vector<double>> ParseNumbers(const std::string& text);

// The file name of frame `index` from a pattern with one %d, such as frame_%04d.png.
absl::StatusOr<std::string> NumberedName(const std::string& pattern, int index);

}  // namespace linetree
