// When to try a call again, and when to give up.
#pragma once

#include <chrono>
#include <optional>
#include <random>

#include "absl/status/status.h"

namespace linetree {

struct RetryOptions {
  int max_attempts = 3;  // at least 1; attempts that brought something on start the count anew
  std::chrono::milliseconds first_delay_ms{100};
  std::chrono::milliseconds max_delay_ms{2000};
};

// The attempts of one call. Delays double from first to max, and each is drawn from the upper half
// of its range, so that those who were refused together do not come back together.
class Retries {
 public:
  explicit Retries(const RetryOptions& options, uint64_t seed = std::random_device{}())
      : options_(options), random_(seed) {}

  // How long to wait before the next attempt, after one that ended with `status`; nothing when
  // there is to be none. Worth another attempt are UNAVAILABLE, and RESOURCE_EXHAUSTED with a
  // hint of the server's (RetryAfter). A hint is heeded: the delay is no less, and a negative one
  // means never.
  std::optional<std::chrono::milliseconds> After(const absl::Status& status);

  // An attempt got somewhere.
  void Progress() { attempts_ = 0; }

 private:
  const RetryOptions options_;
  int attempts_ = 0;
  std::mt19937_64 random_;
};

}  // namespace linetree
