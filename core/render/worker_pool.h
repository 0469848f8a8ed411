// A fixed set of threads that share loops. Not a task scheduler: one loop at a time per call, many
// calls at a time.
//
// Thread safety: ParallelFor may be called from any thread, also from several at once; calls share
// the workers. The caller works too, so a pool of one thread runs everything in the caller.
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
  // threads >= 1; 0 takes the number of hardware threads.
  explicit WorkerPool(int threads);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  int threads() const { return threads_; }

  // Calls body(i) once for every i in [0, count), in any order, and returns when all are done.
  // Adds the CPU time that all threads spent in it to *cpu_ms when given.
  void ParallelFor(size_t count, const std::function<void(size_t)>& body, double* cpu_ms = nullptr);
};

}  // namespace linetree
