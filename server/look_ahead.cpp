#include "server/look_ahead.h"

#include <utility>

#include "core/math/check.h"

namespace linetree {
namespace {

bool HasRoom(SceneHost& host, uint64_t memory_bytes) {
  const double room = kLookAheadShare * static_cast<double>(memory_bytes);
  return static_cast<double>(host.surfaces().ByteSize()) < kSurfaceShare * room &&
         static_cast<double>(host.paths().ByteSize()) < kPathShare * room;
}

}  // namespace

void LookAhead::Offer(const NamedHost& scene, const FrameRequest& frame) {
  if (!on_ || frame.options.mode != Mode::kCached) return;
  const std::lock_guard lock(mutex_);
  next_ = Offered{scene.host, scene.memory_bytes, frame};
  next_->frame.options.ahead = true;
  SubmitIfIdle();
}

void LookAhead::Begin() {
  if (!on_) return;
  const std::lock_guard lock(mutex_);
  ++asked_;
  Disturb();
}

void LookAhead::Yield() {
  if (!on_) return;
  const std::lock_guard lock(mutex_);
  Disturb();
}

void LookAhead::Disturb() {
  yields_ = true;
  if (cancel_) cancel_->Cancel();
  disturbed_.notify_all();
}

void LookAhead::End() {
  if (!on_) return;
  const std::lock_guard lock(mutex_);
  --asked_;
  SubmitIfIdle();
}

void LookAhead::SubmitIfIdle() {
  if (stopping_ || has_job_ || asked_ > 0 || !next_) return;
  const auto pixels =
      static_cast<uint64_t>(next_->frame.width) * static_cast<uint64_t>(next_->frame.height);
  // One job at a time needs no bound of its own.
  const auto job = queue_.Submit({.priority = Priority::kBackground,
                                  .session = "look ahead",
                                  .work_rays = pixels,
                                  .has_place = true},
                                 [this](const absl::Status& turn) { Render(turn); });
  LT_CHECK(job.ok());
  job_ = *job;
  has_job_ = true;
}

void LookAhead::Render(const absl::Status& turn) {
  std::optional<Offered> offered;
  std::shared_ptr<SceneHost> host;
  {
    std::unique_lock lock(mutex_);
    yields_ = false;
    const auto is_disturbed = [&] { return stopping_ || asked_ > 0 || yields_; };
    // Whoever comes goes first; what waits waits on.
    if (turn.ok() && !disturbed_.wait_for(lock, kLeastIdle, is_disturbed) &&
        queue_.waiting() == 0) {
      offered = std::exchange(next_, std::nullopt);
      host = offered ? offered->host.lock() : nullptr;
      if (host) cancel_.emplace();
    }
  }
  // It is for the caches: nobody takes the frame.
  if (host && HasRoom(*host, offered->memory_bytes)) {
    (void)host->RenderFrame(offered->frame, pool_, &*cancel_);
  }
  host.reset();
  const std::lock_guard lock(mutex_);
  cancel_.reset();
  has_job_ = false;
  // Who waits in the queue will say so when it is done.
  if (turn.ok() && queue_.waiting() == 0) SubmitIfIdle();
  ended_.notify_all();
}

void LookAhead::Stop() {
  std::unique_lock lock(mutex_);
  stopping_ = true;
  Disturb();
  if (has_job_) queue_.Withdraw(job_);
  ended_.wait(lock, [this] { return !has_job_; });
}

}  // namespace linetree
