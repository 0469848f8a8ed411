// Frames that flights are likely to ask for, rendered while nobody asks for anything: what the
// caches learn from them is there when it is asked for. At most one is under way, behind everything
// that somebody waits for; as soon as somebody does, it ends within a tile.
//
// Thread safety: all methods may be called from any thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>

#include "core/render/scene_host.h"
#include "server/job_queue.h"
#include "server/scene_store.h"

namespace linetree {

// Of what surface trees and certified linetrees may take; where more is in use, what is learnt
// ahead would push out what is needed.
inline constexpr double kLookAheadShare = 0.75;

// Nobody asks for so long before anything is rendered ahead: clients that ask at once, frame after
// frame, leave nothing to spare.
inline constexpr std::chrono::milliseconds kLeastIdle{10};

class LookAhead {
 public:
  // Both must outlive this; neither may end before Stop has been called. Does nothing unless `on`.
  LookAhead(JobQueue& queue, WorkerPool& pool, bool on) : queue_(queue), pool_(pool), on_(on) {}

  // A frame that may be asked for next; takes the place of one that waits.
  void Offer(const NamedHost& scene, const FrameRequest& frame);

  // Alive while somebody waits for an answer.
  class Asked {
   public:
    explicit Asked(LookAhead& look_ahead) : look_ahead_(look_ahead) { look_ahead_.Begin(); }
    ~Asked() { look_ahead_.End(); }
    Asked(const Asked&) = delete;
    Asked& operator=(const Asked&) = delete;

   private:
    LookAhead& look_ahead_;
  };

  // Somebody is going to ask: what is under way stops within a tile and leaves its thread.
  void Yield();

  // Gives all up and waits for that; later ones are not begun.
  void Stop();

 private:
  struct Offered {
    std::weak_ptr<SceneHost> host;
    uint64_t memory_bytes = 0;
    FrameRequest frame;
  };

  void Begin();
  void End();
  // These need mutex_.
  void Disturb();
  void SubmitIfIdle();

  void Render(const absl::Status& turn);

  JobQueue& queue_;
  WorkerPool& pool_;
  const bool on_;
  std::mutex mutex_;
  std::condition_variable ended_, disturbed_;
  // Guarded by mutex_.
  std::optional<Offered> next_;
  int asked_ = 0;
  bool yields_ = false;                // somebody has come since the job began
  bool has_job_ = false;               // in the queue, or running
  JobId job_ = 0;                      // that
  std::optional<CancelToken> cancel_;  // of the one that is rendered
  bool stopping_ = false;
};

}  // namespace linetree
