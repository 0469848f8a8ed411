// Classes of priority as requests name them.
#pragma once

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "linetree/v1/service.pb.h"
#include "server/schedule.h"

namespace linetree {

// `usual` for requests that name none; INVALID_ARGUMENT for a number that is no class. `path` names
// the field.
absl::StatusOr<Priority> PriorityFromWire(v1::Priority asked, Priority usual,
                                          absl::string_view path);

}  // namespace linetree
