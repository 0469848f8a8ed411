#include "server/job_queue.h"

#include "core/math/check.h"

namespace linetree {

JobQueue::JobQueue(int threads, const Schedule::Limits& limits, absl::Status busy)
    : busy_(std::move(busy)), schedule_(limits) {
  LT_CHECK(threads >= 1);
  for (int i = 0; i < threads; ++i) workers_.emplace_back([this] { Work(); });
  ender_ = std::thread([this] { EndJobs(); });
}

JobQueue::~JobQueue() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  work_changed_.notify_all();
  for (std::thread& worker : workers_) worker.join();
  {
    const std::lock_guard lock(mutex_);
    workers_done_ = true;
  }
  ends_changed_.notify_all();
  ender_.join();
}

absl::StatusOr<JobId> JobQueue::Submit(const JobInfo& info, Job job) {
  const std::lock_guard lock(mutex_);
  const Schedule::Admission admission = schedule_.Add(info);
  for (const JobId id : admission.displaced) Drop(id, busy_);
  if (!admission.job) return busy_;
  jobs_[*admission.job] = std::move(job);
  work_changed_.notify_one();
  if (schedule_.EarliestDeadline() == info.deadline) ends_changed_.notify_one();
  return *admission.job;
}

void JobQueue::Withdraw(JobId id) {
  const std::lock_guard lock(mutex_);
  if (schedule_.Remove(id)) Drop(id, absl::CancelledError("the call was cancelled"));
}

void JobQueue::Drop(JobId id, const absl::Status& why) {
  const auto job = jobs_.find(id);
  dropped_.emplace_back(std::move(job->second), why);
  jobs_.erase(job);
  ends_changed_.notify_one();
}

void JobQueue::DropExpired() {
  for (const JobId id : schedule_.TakeExpired(JobInfo::Clock::now())) {
    Drop(id, absl::DeadlineExceededError("the deadline came before the work could begin"));
  }
}

void JobQueue::Work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    work_changed_.wait(lock, [this] { return stopping_ || !schedule_.empty(); });
    DropExpired();
    const auto id = schedule_.Next();
    if (!id) {
      if (stopping_) return;
      continue;
    }
    {
      const Job job = std::move(jobs_.extract(*id).mapped());
      lock.unlock();
      job(absl::OkStatus());
    }
    lock.lock();
  }
}

void JobQueue::EndJobs() {
  std::unique_lock lock(mutex_);
  for (;;) {
    DropExpired();
    if (!dropped_.empty()) {
      auto dropped = std::exchange(dropped_, {});
      lock.unlock();
      for (const auto& [job, why] : dropped) job(why);
      dropped.clear();
      lock.lock();
      continue;
    }
    if (workers_done_) return;
    const auto deadline = schedule_.EarliestDeadline();
    if (deadline == JobInfo::kNever) {
      ends_changed_.wait(lock);
    } else {
      ends_changed_.wait_until(lock, deadline);
    }
  }
}

size_t JobQueue::waiting() const {
  const std::lock_guard lock(mutex_);
  return schedule_.size();
}

size_t JobQueue::waiting(Priority priority) const {
  const std::lock_guard lock(mutex_);
  return schedule_.size(priority);
}

}  // namespace linetree
