// The typed client of a linetreed.
//
// Every call has a deadline. What fails for want of room (RESOURCE_EXHAUSTED with a hint) or of a
// connection (UNAVAILABLE) is tried again, with delays that grow and are drawn at random, as long
// as the deadline leaves room for it. Calls that a second time might change something else
// (LoadScene with `replace`, UnloadScene, UpdateScene) are tried again only while they are refused,
// before they begin. A lost connection comes back by itself; a flight goes on with the first frame
// that is missing. Other errors, and the last of many, come back as absl::Status with the server's
// words.
//
// client/example/orbit.cpp is an example.
//
// Thread safety: all methods may be called from any thread.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/library/live_flight.h"
#include "client/library/retry.h"
#include "core/io/frame_codec.h"
#include "core/render/scene_host.h"
#include "linetree/v1/service.pb.h"

namespace linetree {

struct ClientOptions {
  std::chrono::milliseconds connect_timeout_ms{5000};
  // Of one call with all its attempts; of one frame for Fly.
  std::chrono::milliseconds call_timeout_ms{600'000};
  RetryOptions retry{};
  // TLS when the roots that the server's certificate must lead to are given; certificate and key
  // for servers that want to see one. All in PEM.
  std::string tls_ca_pem{};
  std::string tls_cert_pem{};
  std::string tls_key_pem{};
  // Shown with every call; empty: none.
  std::string token{};
  // In which class the server queues frames and batches of rays; unspecified: interactive and
  // batch.
  v1::Priority priority = v1::PRIORITY_UNSPECIFIED;
};

class Client {
 public:
  // `address` is host:port. Fails with UNAVAILABLE when nobody answers within connect_timeout_ms,
  // which by TLS may also mean that one of the two does not trust the other.
  static absl::StatusOr<std::unique_ptr<Client>> Connect(const std::string& address,
                                                         const ClientOptions& options = {});
  virtual ~Client() = default;

  virtual absl::StatusOr<v1::SceneInfo> LoadScene(const std::string& name, const v1::Scene& scene,
                                                  bool replace) = 0;
  virtual absl::StatusOr<std::vector<v1::SceneInfo>> ListScenes() = 0;
  virtual absl::StatusOr<v1::SceneInfo> DescribeScene(const std::string& name) = 0;
  virtual absl::Status UnloadScene(const std::string& name) = 0;
  // After UNAVAILABLE the scene's version says whether it was edited.
  virtual absl::StatusOr<v1::UpdateSceneReply> UpdateScene(
      const v1::UpdateSceneRequest& request) = 0;

  // `camera_name` is used when it is set, else request.camera. Layers are empty unless the format
  // has them. Frame::file holds what comes as a file.
  virtual absl::StatusOr<Frame> RenderFrame(const std::string& scene, const FrameRequest& request,
                                            const std::string& camera_name,
                                            const FrameFormat& format,
                                            const Progress& progress) = 0;

  // Sends the requests in order over one stream and hands each frame to `on_frame` as it arrives,
  // each once and in order. When the stream breaks, another takes over.
  virtual absl::Status Fly(const std::string& scene, const std::vector<FrameRequest>& requests,
                           const FrameFormat& format,
                           const std::function<void(size_t index, Frame frame)>& on_frame) = 0;

  // Begins a flight whose viewpoints come while it lasts: see live_flight.h. It must end before the
  // client does.
  virtual std::unique_ptr<LiveFlight> Steer(const std::string& scene, const LiveOptions& options,
                                            LiveFlight::OnFrame on_frame) = 0;

  virtual absl::StatusOr<RayBatch> TraceRays(const std::string& scene, const std::vector<Ray>& rays,
                                             const RenderOptions& options) = 0;
  // Empty scene name: all scenes.
  virtual absl::StatusOr<v1::GetStatsReply> GetStats(const std::string& scene) = 0;
  virtual absl::StatusOr<v1::GetLimitsReply> GetLimits() = 0;
  // Without a policy in it, asks which one a scene has.
  virtual absl::StatusOr<v1::TuneCacheReply> TuneCache(const v1::TuneCacheRequest& request) = 0;
  virtual absl::StatusOr<v1::ExplainReply> Explain(const v1::ExplainRequest& request) = 0;
};

}  // namespace linetree
