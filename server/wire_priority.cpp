#include "server/wire_priority.h"

#include "absl/strings/str_cat.h"

namespace linetree {

absl::StatusOr<Priority> PriorityFromWire(v1::Priority asked, Priority usual,
                                          absl::string_view path) {
  switch (asked) {
    case v1::PRIORITY_UNSPECIFIED:
      return usual;
    case v1::PRIORITY_INTERACTIVE:
      return Priority::kInteractive;
    case v1::PRIORITY_BATCH:
      return Priority::kBatch;
    case v1::PRIORITY_BACKGROUND:
      return Priority::kBackground;
    default:
      return absl::InvalidArgumentError(absl::StrCat(
          path, ": expected one of the values in service.proto, got ", static_cast<int>(asked)));
  }
}

}  // namespace linetree
