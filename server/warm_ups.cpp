#include "server/warm_ups.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/math/check.h"

namespace linetree {

void WarmUps::Start(const NamedHost& scene, std::vector<FrameRequest> frames,
                    std::function<void()> done) {
  LT_CHECK(!frames.empty());
  const auto run = std::make_shared<Run>();
  run->name = scene.name;
  run->host = scene.host;
  run->frames = std::move(frames);
  run->done = std::move(done);
  const std::lock_guard lock(mutex_);
  if (stopping_) return;
  RunPtr& of_scene = by_name_[scene.name];
  if (of_scene) GiveUp(*of_scene);
  of_scene = run;
  ++active_;
  Submit(run);
}

void WarmUps::Submit(const RunPtr& run) {
  // One job per scene, and scenes are counted: these jobs need no bound of their own.
  const auto& [camera, width, height, options, sampling] = run->frames[run->next];
  const auto pixels = static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
  const auto job = queue_.Submit({.priority = Priority::kBackground,
                                  .session = absl::StrCat("warm-up ", run->name),
                                  .work_rays = pixels,
                                  .has_place = true},
                                 [this, run](const absl::Status& turn) { RenderNext(run, turn); });
  LT_CHECK(job.ok());
  run->job = *job;
}

void WarmUps::RenderNext(const RunPtr& run, const absl::Status& turn) {
  bool goes_on = turn.ok();
  if (goes_on) {
    const auto host = run->host.lock();
    goes_on = host && host->RenderFrame(run->frames[run->next], pool_, &run->cancel).ok();
  }
  {
    const std::lock_guard lock(mutex_);
    if (goes_on && ++run->next < run->frames.size() && !run->cancel.IsCancelled()) {
      return Submit(run);
    }
    run->next = run->frames.size();
    const auto of_scene = by_name_.find(run->name);
    if (of_scene != by_name_.end() && of_scene->second == run) by_name_.erase(of_scene);
    if (stopping_) run->done = nullptr;
  }
  if (run->done) run->done();
  const std::lock_guard lock(mutex_);
  --active_;
  ended_.notify_all();
}

void WarmUps::GiveUp(Run& run) {
  run.cancel.Cancel();
  queue_.Withdraw(run.job);
}

uint64_t WarmUps::FramesLeft(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto run = by_name_.find(name);
  return run == by_name_.end() ? 0 : run->second->frames.size() - run->second->next;
}

void WarmUps::Stop() {
  std::unique_lock lock(mutex_);
  stopping_ = true;
  for (const auto& [name, run] : by_name_) GiveUp(*run);
  ended_.wait(lock, [this] { return active_ == 0; });
}

}  // namespace linetree
