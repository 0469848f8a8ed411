// What the server does, as functions of messages, without gRPC: every request is checked here, by
// way of core/io/wire.h, and answered from the scene it names.
//
// Thread safety: all methods may be called from any thread.
#pragma once

#include <spdlog/logger.h>

#include <chrono>
#include <functional>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/audit/live_audit.h"
#include "core/io/frame_codec.h"
#include "core/io/load_scene.h"
#include "core/render/scene_host.h"
#include "linetree/v1/service.pb.h"
#include "server/budget.h"
#include "server/frame_timer.h"
#include "server/job_queue.h"
#include "server/look_ahead.h"
#include "server/metrics.h"
#include "server/open_calls.h"
#include "server/options.h"
#include "server/scene_store.h"
#include "server/stall_watch.h"
#include "server/warm_ups.h"

namespace linetree {

class Backend {
 public:
  // `options` must be valid.
  Backend(const ServerOptions& options, std::shared_ptr<spdlog::logger> log);
  ~Backend() { StopBackground(); }

  const ServerOptions& options() const { return options_; }
  const ServerLimits& limits() const { return options_.limits; }
  // Takes the scenes that options.scenes names.
  absl::Status LoadSceneFiles();
  // Begins the warm-ups that options.warm_ups names, and calls `ready` at the end of the last one,
  // or at once if there are none. Errors are those of the paths.
  absl::Status WarmUp(const std::function<void()>& ready);
  // Writes what was recorded, if anything was to be; errors are logged.
  void SaveTrace() const;
  // Gives up what nobody waits for; `ready` is not called any more.
  void StopBackground() {
    warm_ups_.Stop();
    look_ahead_.Stop();
  }

  absl::StatusOr<v1::SceneInfo> LoadScene(v1::LoadSceneRequest request);
  v1::ListScenesReply ListScenes() const;
  absl::StatusOr<v1::SceneInfo> DescribeScene(const v1::DescribeSceneRequest& request) const;
  absl::StatusOr<v1::UnloadSceneReply> UnloadScene(const v1::UnloadSceneRequest& request);
  // Like LoadScene, one at a time: on loads().
  absl::StatusOr<v1::UpdateSceneReply> UpdateScene(const v1::UpdateSceneRequest& request,
                                                   const CancelToken& cancel);
  absl::StatusOr<v1::GetStatsReply> GetStats(const v1::GetStatsRequest& request) const;
  // As GetStats of all scenes, but without cells and answers by object: what metrics show, at a
  // cost that does not grow with cells or objects.
  v1::GetStatsReply GetSums() const;
  v1::GetLimitsReply GetLimits() const;
  absl::StatusOr<v1::TuneCacheReply> TuneCache(const v1::TuneCacheRequest& request) const;
  // The first one for a scene may have packets to prepare: on loads().
  absl::StatusOr<v1::ExplainReply> Explain(const v1::ExplainRequest& request) const;
  // Leaves the timer where the answers have become a message.
  absl::StatusOr<v1::TraceRaysReply> TraceRays(const v1::TraceRaysRequest& request,
                                               const CancelToken& cancel, FrameTimer& timer);

  // A frame that has been checked and has its memory set aside; nothing is rendered yet.
  struct PreparedFrame {
    Priority priority;
    NamedHost scene;
    FrameRequest request;
    FrameFormat format;
    Budget::Share memory;
  };
  // `path` is a prefix of the paths in errors, "" or "frame.".
  absl::StatusOr<PreparedFrame> PrepareFrame(const v1::RenderFrameRequest& request,
                                             absl::string_view path);
  absl::StatusOr<Frame> Render(const PreparedFrame& frame, const CancelToken& cancel);

  OpenCalls& open_calls() { return open_calls_; }
  // What calls are told that come after these are closed.
  static absl::Status Stopping() { return absl::UnavailableError("the server is stopping"); }
  // Where renders and loads run; both are done when the Backend dies.
  JobQueue& renders() { return renders_; }
  JobQueue& loads() { return loads_; }
  // Places for flights.
  Budget& flights() { return flights_; }
  // Watches what is being sent.
  StallWatch& sends() { return sends_; }
  LookAhead& look_ahead() { return look_ahead_; }
  SceneStore& scenes() { return scenes_; }
  LiveAudit& audit() { return audit_; }
  Load CurrentLoad() const;
  // "No room now" with a hint when to come back.
  absl::Status Busy(absl::string_view what) const;

 private:
  // The scene of a request, not validated.
  absl::StatusOr<std::unique_ptr<SceneSource>> SourceOf(v1::LoadSceneRequest request) const;
  // Builds the scene and keeps it.
  absl::StatusOr<NamedHost> Keep(const std::string& name, const SceneSource& source, bool replace,
                                 std::optional<double> weight = std::nullopt);
  absl::StatusOr<std::vector<FrameRequest>> WarmUpFrames(const v1::WarmUp& warm_up) const;
  v1::SceneInfo InfoOf(const NamedHost& scene) const;
  static v1::GetStatsReply::SceneStats StatsOf(const NamedHost& scene);
  static v1::GetStatsReply::SceneStats SumsOf(const NamedHost& scene);
  void AddServer(v1::GetStatsReply& reply) const;

  const ServerOptions options_;
  const std::shared_ptr<spdlog::logger> log_;
  const std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  const std::unique_ptr<TraceRecorder> recorder_;  // null: nothing is recorded
  const std::unique_ptr<CellStore> cells_;         // null: nothing is kept
  SceneStore scenes_;
  WorkerPool pool_;
  Budget frame_bytes_;
  Budget flights_;
  OpenCalls open_calls_;
  StallWatch sends_;
  LiveAudit audit_;
  // Last: their threads use all of the above.
  WarmUps warm_ups_{renders_, pool_};
  LookAhead look_ahead_;
  JobQueue renders_;
  JobQueue loads_;
};

}  // namespace linetree
