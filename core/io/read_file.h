// Whole files into memory.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"

namespace linetree {

// NOT_FOUND, INVALID_ARGUMENT for a directory, RESOURCE_EXHAUSTED beyond max_bytes; all name the
// path.
absl::StatusOr<std::string> ReadFileAtMost(const std::string& path, uint64_t max_bytes);

}  // namespace linetree
