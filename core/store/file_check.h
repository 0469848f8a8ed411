// Whether LMDB can read a file to its end: it trusts what it finds, so that a file that was cut off
// or written over may end the process that reads it.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace linetree {

// Empty where the folder's data.mdb can be read, or is not there; else what is odd about it, in a
// few words. A child process reads all of it, and may die of it.
std::string OddityOf(const std::string& folder);

// Renames data.mdb to data.mdb.odd, which takes the place of a former one.
absl::Status PutAside(const std::string& folder);

}  // namespace linetree
