#include "server/stall_watch.h"

#include <utility>

namespace linetree {

StallWatch::StallWatch(std::chrono::seconds longest) : longest_(longest) {
  if (longest_.count() > 0) thread_ = std::thread([this] { Watch(); });
}

StallWatch::~StallWatch() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

StallWatch::Id StallWatch::Begin(std::function<void()> stalled) {
  const std::lock_guard lock(mutex_);
  const Id id = ++last_id_;
  if (longest_.count() == 0) return id;
  watched_[id] = {Clock::now() + longest_, std::move(stalled)};
  return id;
}

void StallWatch::End(Id id) {
  const std::lock_guard lock(mutex_);
  watched_.erase(id);
}

void StallWatch::Watch() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    const auto now = Clock::now();
    while (!watched_.empty() && watched_.begin()->second.deadline <= now) {
      watched_.extract(watched_.begin()).mapped().stalled();
    }
    // Nothing that begins meanwhile is stalled before that.
    changed_.wait_until(lock,
                        watched_.empty() ? now + longest_ : watched_.begin()->second.deadline);
  }
}

}  // namespace linetree
