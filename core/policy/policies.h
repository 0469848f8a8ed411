// The eviction policies by name.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/policy/eviction_policy.h"

namespace linetree {

struct PolicyNote {
  std::string_view name;
  std::string_view what;  // in a few words
};

// In the order in which they are listed.
const std::vector<PolicyNote>& AllPolicies();
// Their names with commas between them.
std::string PolicyNames();

// INVALID_ARGUMENT for an unknown name, with those that there are.
absl::StatusOr<std::unique_ptr<EvictionPolicy>> MakePolicy(std::string_view name,
                                                           uint64_t budget_bytes);

}  // namespace linetree
