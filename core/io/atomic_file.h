// Files that appear whole or not at all.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace linetree {

// Writes `bytes` to `path`. A regular file is written beside its place under a temporary name,
// flushed to the disk and renamed, so that a reader sees the old content or the new one and a
// failure leaves what was there. What exists and is no regular file (a pipe, a terminal, /dev/null)
// is written to directly. Errors name the path and the system's reason, and whether there was no
// place (RESOURCE_EXHAUSTED), no such folder (NOT_FOUND) or no permission (PERMISSION_DENIED).
absl::Status WriteFileAtomically(const std::string& path, std::string_view bytes);

}  // namespace linetree
