// The client's calls answered in this process: what --local uses. The same SceneHost that the
// server serves, so that both give the same answers.
//
// Thread safety: all methods may be called from any thread.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "client/library/client.h"

namespace linetree {

class LocalClient : public Client {
 public:
  // threads as for WorkerPool; memory_bytes is the budget of each scene's cache, which evicts by
  // `policy`, one of AllPolicies.
  LocalClient(int threads, uint64_t memory_bytes, std::string policy = kDefaultPolicy);

  // Frames are floats, whatever codec the format names: nothing is sent.

  // As LoadScene, for a scene that has been built already.
  absl::StatusOr<v1::SceneInfo> AddScene(const std::string& name,
                                         std::shared_ptr<const Scene> scene, bool replace);

  // What answers for a scene, or NOT_FOUND. Shared: a scene that is unloaded lives until its last
  // call is done.
  using HostPointer = std::shared_ptr<SceneHost>;
  absl::StatusOr<HostPointer> Find(const std::string& name) const;

  absl::StatusOr<v1::SceneInfo> LoadScene(const std::string& name, const v1::Scene& scene,
                                          bool replace) override;
  absl::StatusOr<std::vector<v1::SceneInfo>> ListScenes() override;
  absl::StatusOr<v1::SceneInfo> DescribeScene(const std::string& name) override;
  absl::Status UnloadScene(const std::string& name) override;
  // FAILED_PRECONDITION: nobody else could see the edited scene.
  absl::StatusOr<v1::UpdateSceneReply> UpdateScene(const v1::UpdateSceneRequest& request) override;
  absl::StatusOr<Frame> RenderFrame(const std::string& scene, const FrameRequest& request,
                                    const std::string& camera_name, const FrameFormat& format,
                                    const Progress& progress) override;
  absl::Status Fly(const std::string& scene, const std::vector<FrameRequest>& requests,
                   const FrameFormat& format,
                   const std::function<void(size_t index, Frame frame)>& on_frame) override;
  // Renders in the thread of Look, which nothing overtakes.
  std::unique_ptr<LiveFlight> Steer(const std::string& scene, const LiveOptions& options,
                                    LiveFlight::OnFrame on_frame) override;
  absl::StatusOr<RayBatch> TraceRays(const std::string& scene, const std::vector<Ray>& rays,
                                     const RenderOptions& options) override;
  absl::StatusOr<v1::GetStatsReply> GetStats(const std::string& scene) override;
  // UNIMPLEMENTED: limits are a server's.
  absl::StatusOr<v1::GetLimitsReply> GetLimits() override;
  absl::StatusOr<v1::TuneCacheReply> TuneCache(const v1::TuneCacheRequest& request) override;
  absl::StatusOr<v1::ExplainReply> Explain(const v1::ExplainRequest& request) override;

 private:
  const uint64_t memory_bytes_;
  const std::string policy_;
  const std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  WorkerPool pool_;
  mutable std::mutex mutex_;
  std::map<std::string, HostPointer> hosts_;  // guarded by mutex_
};

}  // namespace linetree
