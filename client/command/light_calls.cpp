#include "client/command/light_calls.h"

#include <utility>

namespace linetree {

using Clock = std::chrono::steady_clock;

LightCalls::LightCalls(Client& client, std::string scene)
    : client_(client), scene_(std::move(scene)), thread_([this] { Run(); }) {}

LightCalls::~LightCalls() { Finish().IgnoreError(); }

absl::StatusOr<std::vector<double>> LightCalls::Finish() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  stopped_.notify_all();
  if (thread_.joinable()) thread_.join();
  if (!error_.ok()) return error_;
  return latencies_ms_;
}

void LightCalls::Run() {
  for (Clock::time_point intended = Clock::now();; intended += kLightCallPeriod) {
    error_ = client_.GetStats(scene_).status();
    if (!error_.ok()) return;
    latencies_ms_.push_back(
        std::chrono::duration<double, std::milli>(Clock::now() - intended).count());
    std::unique_lock lock(mutex_);
    if (stopped_.wait_until(lock, intended + kLightCallPeriod, [this] { return stop_; })) return;
  }
}

}  // namespace linetree
