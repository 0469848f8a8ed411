#include "client/library/retry.h"

#include <algorithm>

#include "client/library/status.h"

namespace linetree {

std::optional<std::chrono::milliseconds> Retries::After(const absl::Status& status) {
  using std::chrono::milliseconds;
  const auto hint = RetryAfter(status);
  if (!absl::IsUnavailable(status) && !(absl::IsResourceExhausted(status) && hint)) {
    return std::nullopt;
  }
  const milliseconds hint_ms = hint.value_or(milliseconds(0));
  if (hint_ms.count() < 0 || ++attempts_ >= options_.max_attempts) return std::nullopt;
  milliseconds delay_ms = options_.first_delay_ms;
  for (int i = 1; i < attempts_ && delay_ms < options_.max_delay_ms; ++i) delay_ms *= 2;
  delay_ms = std::max(std::min(delay_ms, options_.max_delay_ms), milliseconds(1));
  std::uniform_int_distribution<int64_t> spread(delay_ms.count() / 2, delay_ms.count());
  // After a hint, too, not all at the same time.
  return hint_ms + milliseconds(hint_ms.count() > 0 ? spread(random_) / 2 : spread(random_));
}

}  // namespace linetree
