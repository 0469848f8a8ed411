// Status across gRPC, for both ends: the codes are the same, and a refusal for want of room says
// when to come back.
#pragma once

#include <grpcpp/support/status.h>

#include <chrono>
#include <optional>

#include "absl/status/status.h"

namespace linetree {

// Very long messages are cut.
grpc::Status ToGrpc(const absl::Status& status);
absl::Status FromGrpc(const grpc::Status& status);

// Trailing metadata of a refusal, as gRPC's retry design (gRFC A6) names it: milliseconds after
// which to try again, or a negative number for "never".
inline constexpr char kRetryPushbackKey[] = "grpc-retry-pushback-ms";

// The status with a hint to try again after `delay_ms`.
absl::Status WithRetryAfter(absl::Status status, std::chrono::milliseconds delay_ms);
std::optional<std::chrono::milliseconds> RetryAfter(const absl::Status& status);

}  // namespace linetree
