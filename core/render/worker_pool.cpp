#include "core/render/worker_pool.h"

#include <time.h>

#include <algorithm>
#include <atomic>

namespace linetree {
namespace {

double ThreadCpuMs() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

}  // namespace

struct WorkerPool::Loop {
  size_t count = 0;
  // Valid while `left` > 0, because the caller waits for that.
  const std::function<void(size_t)>* body = nullptr;
  std::atomic<size_t> next{0};
  std::mutex mutex;
  std::condition_variable done;
  size_t left = 0;    // guarded by mutex: iterations that have not ended
  double cpu_ms = 0;  // guarded by mutex
};

WorkerPool::WorkerPool(int threads)
    : threads_(threads > 0 ? threads
                           : std::max(1, static_cast<int>(std::thread::hardware_concurrency()))) {
  for (int i = 1; i < threads_; ++i) workers_.emplace_back([this] { Work(); });
}

WorkerPool::~WorkerPool() {
  {
    std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void WorkerPool::Run(Loop& loop) {
  const double begin = ThreadCpuMs();
  size_t ended = 0;
  for (size_t i; (i = loop.next.fetch_add(1, std::memory_order_relaxed)) < loop.count; ++ended) {
    (*loop.body)(i);
  }
  if (ended == 0) return;
  std::lock_guard lock(loop.mutex);
  loop.cpu_ms += ThreadCpuMs() - begin;
  loop.left -= ended;
  if (loop.left == 0) loop.done.notify_all();
}

void WorkerPool::Work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [this] { return stopping_ || !loops_.empty(); });
    if (stopping_) return;
    const std::shared_ptr<Loop> loop = loops_.front();
    if (loop->next.load(std::memory_order_relaxed) >= loop->count) {
      loops_.pop_front();
      continue;
    }
    lock.unlock();
    Run(*loop);
    lock.lock();
  }
}

void WorkerPool::ParallelFor(size_t count, const std::function<void(size_t)>& body,
                             double* cpu_ms) {
  if (count == 0) return;
  const auto loop = std::make_shared<Loop>();
  loop->count = count;
  loop->left = count;
  loop->body = &body;
  if (count > 1 && threads_ > 1) {
    {
      std::lock_guard lock(mutex_);
      loops_.push_back(loop);
    }
    wake_.notify_all();
  }
  Run(*loop);
  std::unique_lock lock(loop->mutex);
  loop->done.wait(lock, [&] { return loop->left == 0; });
  if (cpu_ms != nullptr) *cpu_ms += loop->cpu_ms;
}

}  // namespace linetree
