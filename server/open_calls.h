// The calls that are being worked on or answered, so that a server that stops can let them end.
//
// Thread safety: all methods may be called from any thread. Must outlive its shares.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>
#include <utility>

namespace linetree {

class OpenCalls {
 public:
  // A call that is open until this dies.
  class Share {
   public:
    Share(Share&& other) noexcept : calls_(std::exchange(other.calls_, nullptr)) {}
    Share& operator=(Share&& other) noexcept {
      std::swap(calls_, other.calls_);
      return *this;
    }
    ~Share() {
      if (calls_ != nullptr) calls_->Leave();
    }

   private:
    friend class OpenCalls;
    explicit Share(OpenCalls* calls) : calls_(calls) {}
    OpenCalls* calls_;
  };

  // Nothing after Close.
  std::optional<Share> Enter() {
    const std::lock_guard lock(mutex_);
    if (closed_) return std::nullopt;
    ++open_;
    return Share(this);
  }

  // Returns when no call is open any more, or at the deadline. If any was, the last one's client
  // gets `grace` more to read what was sent, of which nobody tells us.
  void Close(std::chrono::steady_clock::time_point deadline, std::chrono::milliseconds grace) {
    std::unique_lock lock(mutex_);
    closed_ = true;
    if (open_ == 0) return;
    none_open_.wait_until(lock, deadline, [this] { return open_ == 0; });
    const auto end = std::min(deadline, std::chrono::steady_clock::now() + grace);
    none_open_.wait_until(lock, end, [] { return false; });
  }

  // Returns when the last share is gone: threads that end calls may hold one for a moment longer
  // than gRPC knows of the call.
  void AwaitNone() {
    std::unique_lock lock(mutex_);
    none_open_.wait(lock, [this] { return open_ == 0; });
  }

 private:
  void Leave() {
    const std::lock_guard lock(mutex_);
    if (--open_ == 0) none_open_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable none_open_;
  size_t open_ = 0;      // guarded by mutex_
  bool closed_ = false;  // guarded by mutex_
};

}  // namespace linetree
