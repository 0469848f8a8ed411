// A fixed set of threads that share loops. Not a task scheduler: a loop is split into its
// iterations, and whoever is free takes the next one.
//
// Thread safety: ParallelFor may be called from any thread, also from several at once; calls share
// the workers, oldest first. It must not be called from inside a body.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace linetree {

class WorkerPool {
 public:
  // At least one thread; 0 takes the number of hardware threads.
  explicit WorkerPool(int threads);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  int threads() const { return threads_; }

  // Calls body(i) once for every i in [0, count), in any order, and returns when all are done. The
  // caller works too, so a pool of one thread runs everything in the caller. Adds the CPU time that
  // all threads spent on it to *cpu_ms when given.
  void ParallelFor(size_t count, const std::function<void(size_t)>& body, double* cpu_ms = nullptr);

 private:
  struct Loop;

  void Work();
  static void Run(Loop& loop);

  const int threads_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::shared_ptr<Loop>> loops_;  // guarded by mutex_: those that still want workers
  bool stopping_ = false;                    // guarded by mutex_
  std::vector<std::thread> workers_;
};

}  // namespace linetree
