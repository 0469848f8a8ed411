#include "core/audit/bounded_queue.h"

#include <gtest/gtest.h>

#include <memory>
#include <thread>
#include <vector>

namespace linetree {
namespace {

TEST(BoundedQueueTest, FirstInFirstOutRoundAfterRound) {
  BoundedQueue<int> queue(4);
  int next_in = 0, next_out = 0;
  for (int round = 0; round < 10; ++round) {
    for (int i = 0; i < 3; ++i) {
      int entry = next_in++;
      ASSERT_TRUE(queue.TryPush(entry));
    }
    for (int i = 0; i < 3; ++i) ASSERT_EQ(queue.TryPop(), next_out++);
    ASSERT_EQ(queue.TryPop(), std::nullopt);
  }
}

TEST(BoundedQueueTest, RefusesWhatItHasNoPlaceForAndLeavesItAlone) {
  BoundedQueue<std::unique_ptr<int>> queue(3);  // has 4 places
  for (int i = 0; i < 4; ++i) {
    auto entry = std::make_unique<int>(i);
    ASSERT_TRUE(queue.TryPush(entry));
    EXPECT_EQ(entry, nullptr);
  }
  auto refused = std::make_unique<int>(4);
  EXPECT_FALSE(queue.TryPush(refused));
  EXPECT_EQ(*refused, 4);
  EXPECT_EQ(**queue.TryPop(), 0);
  EXPECT_TRUE(queue.TryPush(refused));
}

TEST(BoundedQueueTest, TheSmallestLosesNothingEither) {
  for (const size_t places : {0, 1, 2}) {
    BoundedQueue<int> queue(places);
    int pushed = 0;
    for (int i = 0; i < 5; ++i) pushed += queue.TryPush(i);
    EXPECT_EQ(pushed, 2);
    EXPECT_EQ(queue.TryPop(), 0);
    EXPECT_EQ(queue.TryPop(), 1);
    EXPECT_EQ(queue.TryPop(), std::nullopt);
  }
}

TEST(BoundedQueueTest, KeepsNothingOfWhatWasTaken) {
  BoundedQueue<std::shared_ptr<int>> queue(2);
  auto entry = std::make_shared<int>(1);
  const std::weak_ptr<int> watch = entry;
  ASSERT_TRUE(queue.TryPush(entry));
  queue.TryPop().reset();
  EXPECT_TRUE(watch.expired());
}

TEST(BoundedQueueTest, ManyProducersLoseNothing) {
  constexpr int kProducers = 3, kEach = 20'000;
  BoundedQueue<int> queue(64);
  std::atomic<int> running{kProducers};
  std::vector<std::thread> producers;
  for (int p = 0; p < kProducers; ++p) {
    producers.emplace_back([&, p] {
      for (int i = 0; i < kEach; ++i) {
        int entry = p * kEach + i;
        while (!queue.TryPush(entry)) std::this_thread::yield();
      }
      --running;
    });
  }
  std::vector<int> last(kProducers, -1);
  int taken = 0;
  while (taken < kProducers * kEach) {
    const auto entry = queue.TryPop();
    if (!entry) {
      std::this_thread::yield();
      continue;
    }
    ++taken;
    const auto producer = static_cast<size_t>(*entry / kEach);
    ASSERT_GT(*entry % kEach, last[producer]);  // of each producer in order
    last[producer] = *entry % kEach;
  }
  for (std::thread& producer : producers) producer.join();
  EXPECT_EQ(queue.TryPop(), std::nullopt);
}

}  // namespace
}  // namespace linetree
