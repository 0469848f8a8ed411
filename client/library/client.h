// The typed client: every call has a deadline, refusals come back as absl::Status with the server's
// words. UNAVAILABLE and "no room now" are retried as long as nothing of the answer has come (calls
// change nothing that a second try would change again).
//
// Thread safety: all methods may be called from any thread.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/render/scene_host.h"
#include "linetree/v1/service.pb.h"

namespace linetree {

struct ClientOptions {
  std::chrono::milliseconds connect_timeout_ms{5000};
  // Of one call; of one frame for Fly.
  std::chrono::milliseconds call_timeout_ms{600'000};
  int max_attempts = 3;  // in [1, 5]
};

class Client {
 public:
  // `address` is host:port. Fails with UNAVAILABLE when nobody answers within connect_timeout_ms.
  static absl::StatusOr<std::unique_ptr<Client>> Connect(const std::string& address,
                                                         const ClientOptions& options = {});
  virtual ~Client() = default;

  virtual absl::StatusOr<v1::SceneInfo> LoadScene(const std::string& name, const v1::Scene& scene,
                                                  bool replace) = 0;
  virtual absl::StatusOr<std::vector<v1::SceneInfo>> ListScenes() = 0;
  virtual absl::StatusOr<v1::SceneInfo> DescribeScene(const std::string& name) = 0;
  virtual absl::Status UnloadScene(const std::string& name) = 0;

  // `camera_name` is used when it is set, else request.camera. Layers are empty unless all_layers.
  virtual absl::StatusOr<Frame> RenderFrame(const std::string& scene, const FrameRequest& request,
                                            const std::string& camera_name, bool all_layers,
                                            const Progress& progress) = 0;

  // Sends the requests in order over one stream and hands each frame to `on_frame` as it arrives.
  virtual absl::Status Fly(const std::string& scene, const std::vector<FrameRequest>& requests,
                           bool all_layers,
                           const std::function<void(size_t index, Frame frame)>& on_frame) = 0;

  virtual absl::StatusOr<RayBatch> TraceRays(const std::string& scene, const std::vector<Ray>& rays,
                                             const RenderOptions& options) = 0;
  // Empty scene name: all scenes.
  virtual absl::StatusOr<v1::GetStatsReply> GetStats(const std::string& scene) = 0;
};

}  // namespace linetree
