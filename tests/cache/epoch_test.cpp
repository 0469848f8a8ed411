// What is taken away is destroyed when nobody reads it any more, and readers wait for nobody.
#include "core/cache/epoch.h"

#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <memory>
#include <thread>
#include <vector>

#include "core/tree/owning_slot.h"

namespace linetree {
namespace {

class EpochTest : public testing::TestWithParam<EpochKind> {
 protected:
  EpochTest() { SetEpochKind(GetParam()); }
  ~EpochTest() override { SetEpochKind(EpochKind::kRcu); }
};

TEST_P(EpochTest, WhoHasTakenAwayWaitsForReaders) {
  std::atomic<bool> has_waited{false};
  std::latch begun(2);
  std::thread waiter;
  {
    const EpochGuard outer;
    const EpochGuard inner;  // nested ones count as one
    waiter = std::thread([&] {
      begun.arrive_and_wait();
      AwaitReaders();
      has_waited = true;
    });
    begun.arrive_and_wait();
    for (int i = 0; i < 1000; ++i) std::this_thread::yield();
    EXPECT_FALSE(has_waited);
  }
  waiter.join();
  EXPECT_TRUE(has_waited);
}

TEST_P(EpochTest, NobodyWaitsWhereNobodyReads) {
  { const EpochGuard guard; }
  AwaitReaders();
  AwaitReaders();
}

// A thing that knows whether it is still there.
struct Thing {
  explicit Thing(int n) : value(n), twice(2 * n) {}
  ~Thing() { value = -1; }
  std::atomic<int> value;
  int twice;
};

TEST_P(EpochTest, ReadersNeverSeeWhatIsGone) {
  OwningSlot<Thing> slot;
  std::atomic<bool> stops{false};
  std::atomic<int> odd{0};
  std::atomic<int64_t> seen{0};
  std::vector<std::thread> readers;
  for (int r = 0; r < 3; ++r) {
    readers.emplace_back([&] {
      while (!stops) {
        const EpochGuard reading;
        const Thing* thing = slot.get();
        if (thing == nullptr) continue;
        const int twice = thing->twice;
        if (2 * thing->value != twice) ++odd;
        ++seen;
      }
    });
  }
  for (int n = 1; n < 300 || seen < 1000; ++n) {
    auto thing = std::make_unique<Thing>(n);
    ASSERT_TRUE(slot.PutFirst(thing));
    if (n % 8 == 0) std::this_thread::yield();
    const std::unique_ptr<Thing> old = slot.Take();
    AwaitReaders();
  }
  stops = true;
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(odd, 0);
}

TEST(EpochDeathTest, WhoReadsMustNotWaitForReaders) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_DEATH(
      {
        const EpochGuard guard;
        AwaitReaders();
      },
      "guards == 0");
}

TEST(OwningSlotTest, HoldsWhatComesFirst) {
  OwningSlot<int> slot;
  EXPECT_FALSE(slot);
  auto first = std::make_unique<int>(1), second = std::make_unique<int>(2);
  EXPECT_TRUE(slot.PutFirst(first));
  EXPECT_EQ(first, nullptr);
  EXPECT_FALSE(slot.PutFirst(second));
  EXPECT_NE(second, nullptr);
  EXPECT_EQ(*slot, 1);
  EXPECT_EQ(*slot.Take(), 1);
  EXPECT_FALSE(slot);
}

INSTANTIATE_TEST_SUITE_P(Kinds, EpochTest, testing::Values(EpochKind::kRcu, EpochKind::kSharedLock),
                         [](const auto& of) {
                           return of.param == EpochKind::kRcu ? "Rcu" : "SharedLock";
                         });

}  // namespace
}  // namespace linetree
