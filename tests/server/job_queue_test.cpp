#include "server/job_queue.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <memory>

namespace linetree {
namespace {

const absl::Status kBusy = absl::ResourceExhaustedError("busy");

// Submits a job and lets the test wait for how it ended.
std::future<absl::Status> Watched(JobQueue& queue, const JobInfo& info, JobId* id = nullptr) {
  const auto ended = std::make_shared<std::promise<absl::Status>>();
  const auto job =
      queue.Submit(info, [ended](const absl::Status& status) { ended->set_value(status); });
  if (!job.ok()) ended->set_value(job.status());
  if (job.ok() && id != nullptr) *id = *job;
  return ended->get_future();
}

// A queue of one thread that is busy until the gate opens.
class BusyQueue {
 public:
  explicit BusyQueue(const Schedule::Limits& limits = {}) : queue_(1, limits, kBusy) {
    std::promise<void> runs;
    EXPECT_TRUE(queue_
                    .Submit({},
                            [&](const absl::Status&) {
                              runs.set_value();
                              gate_.get_future().wait();
                            })
                    .ok());
    runs.get_future().wait();
  }
  ~BusyQueue() { Open(); }
  void Open() {
    if (!std::exchange(open_, true)) gate_.set_value();
  }
  JobQueue& operator*() { return queue_; }

 private:
  bool open_ = false;
  std::promise<void> gate_;
  JobQueue queue_;
};

TEST(JobQueueTest, ItsEndDoesWhatStillWaits) {
  std::atomic<int> done = 0;
  {
    JobQueue queue(1, {}, kBusy);
    for (int i = 0; i < 50; ++i) {
      EXPECT_TRUE(queue.Submit({}, [&](const absl::Status& status) { done += status.ok(); }).ok());
    }
  }
  EXPECT_EQ(done, 50);
}

TEST(JobQueueTest, SeveralThreadsWorkAtATime) {
  // Each waits for the other to have begun: with one thread this would never end.
  std::promise<void> a_runs, b_runs, both_done;
  JobQueue queue(2, {}, kBusy);  // dies first, with its jobs
  EXPECT_TRUE(queue
                  .Submit({},
                          [&](const absl::Status&) {
                            a_runs.set_value();
                            b_runs.get_future().wait();
                            both_done.set_value();
                          })
                  .ok());
  EXPECT_TRUE(queue
                  .Submit({},
                          [&](const absl::Status&) {
                            b_runs.set_value();
                            a_runs.get_future().wait();
                          })
                  .ok());
  both_done.get_future().wait();
}

TEST(JobQueueTest, AFullQueueRefusesAndDisplaces) {
  BusyQueue queue({.max_waiting = 2});
  auto first = Watched(*queue, {.session = "greedy"});
  auto second = Watched(*queue, {.session = "greedy"});
  EXPECT_EQ(Watched(*queue, {.session = "greedy"}).get(), kBusy);
  auto other = Watched(*queue, {.session = "other"});
  EXPECT_EQ(second.get(), kBusy);
  queue.Open();
  EXPECT_TRUE(first.get().ok());
  EXPECT_TRUE(other.get().ok());
}

TEST(JobQueueTest, ADeadlineEndsAJobWhileAllThreadsAreBusy) {
  BusyQueue queue;
  const auto now = JobInfo::Clock::now();
  auto patient = Watched(*queue, {.deadline = now + std::chrono::hours(1)});
  auto soon = Watched(*queue, {.deadline = now + std::chrono::milliseconds(30)});
  auto past = Watched(*queue, {.deadline = now - std::chrono::milliseconds(1)});
  EXPECT_TRUE(absl::IsDeadlineExceeded(past.get()));
  EXPECT_TRUE(absl::IsDeadlineExceeded(soon.get()));
  EXPECT_GE(JobInfo::Clock::now(), now + std::chrono::milliseconds(30));
  queue.Open();
  EXPECT_TRUE(patient.get().ok());
}

TEST(JobQueueTest, AWithdrawnJobEndsAndMakesRoom) {
  BusyQueue queue({.max_waiting = 1});
  JobId id = 0;
  auto withdrawn = Watched(*queue, {}, &id);
  (*queue).Withdraw(id);
  EXPECT_TRUE(absl::IsCancelled(withdrawn.get()));
  auto next = Watched(*queue, {});
  (*queue).Withdraw(id);  // says nothing any more
  queue.Open();
  EXPECT_TRUE(next.get().ok());
}

}  // namespace
}  // namespace linetree
