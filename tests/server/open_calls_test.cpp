#include "server/open_calls.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace linetree {
namespace {

TEST(OpenCallsTest, NobodyEntersWhatIsClosed) {
  OpenCalls calls;
  EXPECT_TRUE(calls.Enter());
  calls.Close(std::chrono::steady_clock::now(), std::chrono::milliseconds(0));
  EXPECT_FALSE(calls.Enter());
}

TEST(OpenCallsTest, WhoeverAwaitsTheLastShareOutlivesIt) {
  OpenCalls calls;
  calls.AwaitNone();
  for (int round = 0; round < 100; ++round) {
    std::atomic<bool> left = false;
    auto share = calls.Enter();
    std::thread leaver([&left, share = std::move(*share)]() mutable {
      const auto last = std::move(share);
      std::this_thread::yield();
      left = true;
    });
    share.reset();  // moved from: no share
    calls.AwaitNone();
    EXPECT_TRUE(left);
    leaver.join();
  }
}

}  // namespace
}  // namespace linetree
