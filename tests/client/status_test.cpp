#include "client/library/status.h"

#include <gtest/gtest.h>

namespace linetree {
namespace {

TEST(StatusTest, EveryCodeAndTheWordsGoThereAndBack) {
  for (int code = 0; code <= 16; ++code) {
    const absl::Status status(static_cast<absl::StatusCode>(code), code == 0 ? "" : "why");
    EXPECT_EQ(FromGrpc(ToGrpc(status)), status);
    EXPECT_EQ(ToGrpc(status).error_code(), code);
  }
}

TEST(StatusTest, EndlessWordsAreCut) {
  const grpc::Status status = ToGrpc(absl::InternalError(std::string(100'000, 'x')));
  EXPECT_LT(status.error_message().size(), 8192u / 3);
  EXPECT_GT(status.error_message().size(), 1000u);
}

TEST(StatusTest, AHintTravelsWithItsStatus) {
  const auto status =
      WithRetryAfter(absl::ResourceExhaustedError("full"), std::chrono::milliseconds(250));
  EXPECT_TRUE(absl::IsResourceExhausted(status));
  EXPECT_EQ(RetryAfter(status), std::chrono::milliseconds(250));
  EXPECT_EQ(RetryAfter(absl::ResourceExhaustedError("too large")), std::nullopt);
}

}  // namespace
}  // namespace linetree
