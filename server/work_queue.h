// Threads of our own for work that gRPC's callback threads must not do: they only start and finish
// calls.
//
// Thread safety: all methods may be called from any thread.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace linetree {

class WorkQueue {
 public:
  using Job = std::function<void()>;

  // Jobs run on `threads` threads in the order in which they came.
  WorkQueue(int threads, size_t max_waiting);
  // Runs what still waits: whoever submitted a job may rely on it.
  ~WorkQueue();
  WorkQueue(const WorkQueue&) = delete;
  WorkQueue& operator=(const WorkQueue&) = delete;

  // False, and the job is dropped, when max_waiting jobs wait already.
  [[nodiscard]] bool TrySubmit(Job job);
  // For callers whose number is bounded elsewhere and who submit one job at a time.
  void Submit(Job job);

  // Jobs that wait.
  size_t waiting() const;

 private:
  void Run();

  const size_t max_waiting_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded by mutex_.
  std::deque<Job> waiting_;
  bool stopping_ = false;

  std::vector<std::thread> threads_;
};

}  // namespace linetree
