// Frames that are rendered for what the caches learn from them, one after another and behind
// everything that callers wait for.
//
// Thread safety: all methods may be called from any thread.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/render/scene_host.h"
#include "server/job_queue.h"
#include "server/scene_store.h"

namespace linetree {

class WarmUps {
 public:
  // Both must outlive this; neither may end before Stop has been called.
  WarmUps(JobQueue& queue, WorkerPool& pool) : queue_(queue), pool_(pool) {}

  // Renders the frames, which are valid, of the scene; another warm-up under its name is given up.
  // Ends early when nobody else holds the scene any more. `done` is called at the end of all, from
  // a thread of the queue; not after Stop.
  void Start(const NamedHost& scene, std::vector<FrameRequest> frames,
             std::function<void()> done = nullptr);
  // Of the scene of this name; 0: no warm-up is under way.
  uint64_t FramesLeft(const std::string& name) const;

  // Gives all up and waits for that; later ones are not begun.
  void Stop();

 private:
  struct Run {
    std::string name;
    std::weak_ptr<SceneHost> host;
    std::vector<FrameRequest> frames;
    std::function<void()> done;
    CancelToken cancel;
    size_t next = 0;  // guarded by mutex_, as is job
    JobId job = 0;
  };
  using RunPtr = std::shared_ptr<Run>;

  // These need mutex_.
  void Submit(const RunPtr& run);
  void GiveUp(Run& run);

  void RenderNext(const RunPtr& run, const absl::Status& turn);

  JobQueue& queue_;
  WorkerPool& pool_;
  mutable std::mutex mutex_;
  std::condition_variable ended_;
  // Guarded by mutex_.
  std::map<std::string, RunPtr> by_name_;
  size_t active_ = 0;  // also those that were given up, until they notice
  bool stopping_ = false;
};

}  // namespace linetree
