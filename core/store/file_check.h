// Whether LMDB can read a file to its end: it trusts what it finds, so that a file that was cut off
// or written over may end the process that reads it.
#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace linetree {

// Empty where the folder's data.mdb can be read, or is not there; else what is odd about it, in a
// few words. A child process reads all of it, and may die of it. UNAVAILABLE where that cannot be
// told: there is no child, or it may not read the file or takes too long.
absl::StatusOr<std::string> OddityOf(const std::string& folder);

// Renames data.mdb to a name that no file has yet, data.mdb.odd if possible, which it returns.
absl::StatusOr<std::string> PutAside(const std::string& folder);

}  // namespace linetree
