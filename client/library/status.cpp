#include "client/library/status.h"

#include <string>

#include "absl/strings/cord.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"

namespace linetree {
namespace {

constexpr char kRetryPayload[] = "linetree/retry-after-ms";

// gRPC refuses metadata of more than 8 KiB; percent-encoding may triple a message.
constexpr size_t kMaxMessageBytes = 2048;

}  // namespace

grpc::Status ToGrpc(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  return {static_cast<grpc::StatusCode>(status.raw_code()),
          std::string(status.message().substr(0, kMaxMessageBytes))};
}

absl::Status FromGrpc(const grpc::Status& status) {
  if (status.ok()) return absl::OkStatus();
  return {static_cast<absl::StatusCode>(status.error_code()), status.error_message()};
}

absl::Status WithRetryAfter(absl::Status status, std::chrono::milliseconds delay_ms) {
  status.SetPayload(kRetryPayload, absl::Cord(absl::StrCat(delay_ms.count())));
  return status;
}

std::optional<std::chrono::milliseconds> RetryAfter(const absl::Status& status) {
  const auto payload = status.GetPayload(kRetryPayload);
  int64_t delay_ms = 0;
  if (!payload || !absl::SimpleAtoi(std::string(*payload), &delay_ms)) return std::nullopt;
  return std::chrono::milliseconds(delay_ms);
}

}  // namespace linetree
