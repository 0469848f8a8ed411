// Threads of our own for work that gRPC's callback threads must not do (they only start and finish
// calls), in the order that a Schedule says.
//
// Thread safety: all methods may be called from any thread, also while holding locks that jobs
// take: no job is called from within a method.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "server/schedule.h"

namespace linetree {

class JobQueue {
 public:
  // Called once. OK: it is this job's turn, and the thread is its own until it returns. Else the
  // work will not be done: DEADLINE_EXCEEDED when the deadline came first, CANCELLED when the job
  // was withdrawn, and `busy` when another took its room; that call shall return soon.
  using Job = std::function<void(const absl::Status& status)>;

  // Works on `threads` jobs at a time. `busy` is what those are told that find no room.
  JobQueue(int threads, const Schedule::Limits& limits, absl::Status busy);
  // Does what still waits: whoever submitted a job may rely on it.
  ~JobQueue();
  JobQueue(const JobQueue&) = delete;
  JobQueue& operator=(const JobQueue&) = delete;

  // `busy` when there is no room; the job is then dropped without being called.
  absl::StatusOr<JobId> Submit(const JobInfo& info, Job job);
  // Ends the job soon if it still waits.
  void Withdraw(JobId id);
  // Jobs that wait.
  size_t waiting() const;
  size_t waiting(Priority priority) const;

 private:
  void Work();
  void EndJobs();
  // These need mutex_. The job is ended by ender_.
  void Drop(JobId id, const absl::Status& why);
  void DropExpired();

  const absl::Status busy_;
  mutable std::mutex mutex_;
  std::condition_variable work_changed_, ends_changed_;
  // Guarded by mutex_.
  Schedule schedule_;
  std::map<JobId, Job> jobs_;  // those of the schedule
  std::vector<std::pair<Job, absl::Status>> dropped_;
  bool stopping_ = false;
  bool workers_done_ = false;

  std::vector<std::thread> workers_;
  // Ends jobs that will not be done; wakes for deadlines.
  std::thread ender_;
};

}  // namespace linetree
