#include "server/work_queue.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>

namespace linetree {
namespace {

TEST(WorkQueueTest, JobsRunInTheOrderInWhichTheyCame) {
  std::vector<int> order;
  {
    WorkQueue queue(1, 100);
    for (int i = 0; i < 50; ++i) {
      EXPECT_TRUE(queue.TrySubmit([&order, i] { order.push_back(i); }));
    }
  }
  ASSERT_EQ(order.size(), 50u);
  EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
}

TEST(WorkQueueTest, AFullQueueRefusesUntilThereIsRoom) {
  std::promise<void> open_gate, first_runs;
  const std::shared_future<void> gate = open_gate.get_future().share();
  std::atomic<int> done = 0;
  {
    WorkQueue queue(1, 1);
    EXPECT_TRUE(queue.TrySubmit([&] {
      first_runs.set_value();
      gate.wait();
      ++done;
    }));
    first_runs.get_future().wait();
    EXPECT_TRUE(queue.TrySubmit([&] { ++done; }));
    EXPECT_FALSE(queue.TrySubmit([&] { done += 100; }));
    queue.Submit([&] { ++done; });
    open_gate.set_value();
  }
  EXPECT_EQ(done, 3);
}

TEST(WorkQueueTest, SeveralThreadsWorkAtATime) {
  // Each waits for the other to have begun: with one thread this would never end.
  std::promise<void> a_runs, b_runs, both_done;
  WorkQueue queue(2, 10);  // dies first, with its jobs
  queue.Submit([&] {
    a_runs.set_value();
    b_runs.get_future().wait();
    both_done.set_value();
  });
  queue.Submit([&] {
    b_runs.set_value();
    a_runs.get_future().wait();
  });
  both_done.get_future().wait();
}

}  // namespace
}  // namespace linetree
