#include "client/library/retry.h"

#include <gtest/gtest.h>

#include <set>

#include "client/library/status.h"

namespace linetree {
namespace {

using std::chrono::milliseconds;

const absl::Status kUnavailable = absl::UnavailableError("not now");

TEST(RetriesTest, DelaysDoubleUpToTheLargest) {
  for (uint64_t seed = 0; seed < 100; ++seed) {
    Retries retries({.max_attempts = 7,
                     .first_delay_ms = milliseconds(100),
                     .max_delay_ms = milliseconds(1000)},
                    seed);
    for (const int whole_ms : {100, 200, 400, 800, 1000, 1000}) {
      const auto delay_ms = retries.After(kUnavailable);
      ASSERT_TRUE(delay_ms);
      EXPECT_GE(delay_ms->count(), whole_ms / 2);
      EXPECT_LE(delay_ms->count(), whole_ms);
    }
    EXPECT_FALSE(retries.After(kUnavailable)) << "the seventh attempt was the last";
  }
}

TEST(RetriesTest, NoTwoClientsWaitAlike) {
  std::set<int64_t> delays_ms;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    delays_ms.insert(
        Retries({.first_delay_ms = milliseconds(1000)}, seed).After(kUnavailable)->count());
  }
  EXPECT_GT(delays_ms.size(), 10u);
}

TEST(RetriesTest, TheServersHintIsHeeded) {
  const auto full = absl::ResourceExhaustedError("full");
  Retries retries({});
  EXPECT_FALSE(retries.After(full)) << "without a hint it is for good";
  EXPECT_FALSE(retries.After(WithRetryAfter(full, milliseconds(-1))));
  EXPECT_FALSE(retries.After(WithRetryAfter(kUnavailable, milliseconds(-1))));
  const auto delay_ms = retries.After(WithRetryAfter(full, milliseconds(5000)));
  ASSERT_TRUE(delay_ms);
  EXPECT_GE(delay_ms->count(), 5000);
}

TEST(RetriesTest, OtherErrorsAreTheLastWord) {
  for (const auto& status :
       {absl::NotFoundError(""), absl::InvalidArgumentError(""), absl::DeadlineExceededError(""),
        absl::CancelledError(""), absl::UnauthenticatedError(""), absl::InternalError("")}) {
    EXPECT_FALSE(Retries({}).After(status)) << status;
  }
}

TEST(RetriesTest, ProgressStartsTheCountAnew) {
  Retries retries({.max_attempts = 2});
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(retries.After(kUnavailable));
    retries.Progress();
  }
  EXPECT_TRUE(retries.After(kUnavailable));
  EXPECT_FALSE(retries.After(kUnavailable));
}

}  // namespace
}  // namespace linetree
