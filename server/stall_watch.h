// Notices clients that take nothing any more, though their connection lives: a call of theirs would
// hold its frame for as long as they like.
//
// Thread safety: all methods may be called from any thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <thread>

namespace linetree {

class StallWatch {
 public:
  using Id = uint64_t;

  // What lasts longer than this is stalled; 0: nothing is.
  explicit StallWatch(std::chrono::seconds longest);
  ~StallWatch();
  StallWatch(const StallWatch&) = delete;
  StallWatch& operator=(const StallWatch&) = delete;

  // Something has begun. Unless it ends in time, `stalled` is called, once, on a thread of the
  // watch's own; it must not call the watch.
  Id Begin(std::function<void()> stalled);
  // It has ended. Waits while its `stalled` is being called, and it is not called afterwards.
  void End(Id id);

 private:
  using Clock = std::chrono::steady_clock;
  struct Watched {
    Clock::time_point deadline;
    std::function<void()> stalled;
  };
  void Watch();

  const std::chrono::seconds longest_;
  std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded by mutex_.
  Id last_id_ = 0;
  std::map<Id, Watched> watched_;  // and so by deadline
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace linetree
