// ServerLimits as data, for whoever asks what a server allows.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "server/limits.h"

namespace linetree {

struct NamedLimit {
  std::string_view name;  // of the member; within a group "group.member"
  uint64_t value;
  std::string_view bounds;  // what it bounds, and in which unit
};

// All members, once each. A new one does not compile until it is listed.
std::vector<NamedLimit> ListLimits(const ServerLimits& limits);

}  // namespace linetree
