// The folder that clients may load scenes from.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace linetree {

// The content of the file at `path` from the folder `root`, which the server's owner has named. No
// path gets out of it, whatever stands in it and however it changes meanwhile: each step is opened
// by its own name in the folder before, and neither ".." nor a symbolic link is one.
// PERMISSION_DENIED for such paths and for absolute ones, NOT_FOUND, INVALID_ARGUMENT for what is
// no plain file, RESOURCE_EXHAUSTED beyond max_bytes. `field` names the path in errors.
absl::StatusOr<std::string> ReadFileBelow(const std::string& root, absl::string_view path,
                                          uint64_t max_bytes, absl::string_view field);

}  // namespace linetree
