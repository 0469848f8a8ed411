#include "client/command/local_client.h"

#include <condition_variable>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/io/load_scene.h"
#include "core/io/wire.h"
#include "core/io/wire_explain.h"

namespace linetree {

LocalClient::LocalClient(int threads, uint64_t memory_bytes, std::string policy)
    : memory_bytes_(memory_bytes), policy_(std::move(policy)), pool_(threads) {}

absl::StatusOr<LocalClient::HostPointer> LocalClient::Find(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto found = hosts_.find(name);
  if (found != hosts_.end()) return found->second;
  return absl::NotFoundError(
      absl::StrCat("no scene '", name, "'; with --local a scene is given as a file"));
}

absl::StatusOr<v1::SceneInfo> LocalClient::AddScene(const std::string& name,
                                                    std::shared_ptr<const Scene> scene,
                                                    bool replace) {
  const std::lock_guard lock(mutex_);
  HostPointer& host = hosts_[name];
  if (host == nullptr || (replace && host->scene().version != scene->version)) {
    host = std::make_shared<SceneHost>(
        scene, CacheOptions{.memory_bytes = memory_bytes_, .policy = policy_});
  } else if (host->scene().version != scene->version) {
    return absl::AlreadyExistsError(absl::StrCat("there is another scene '", name, "'"));
  }
  return SceneInfoToWire(name, host->scene(), host->CacheBytes());
}

absl::StatusOr<v1::SceneInfo> LocalClient::LoadScene(const std::string& name,
                                                     const v1::Scene& scene, bool replace) {
  auto built = BuildScene(*SceneFromMessage(scene));
  if (!built.ok()) return built.status();
  return AddScene(name, *std::move(built), replace);
}

absl::StatusOr<std::vector<v1::SceneInfo>> LocalClient::ListScenes() {
  const std::lock_guard lock(mutex_);
  std::vector<v1::SceneInfo> infos;
  for (const auto& [name, host] : hosts_) {
    infos.push_back(SceneInfoToWire(name, host->scene(), host->CacheBytes()));
  }
  return infos;
}

absl::StatusOr<v1::SceneInfo> LocalClient::DescribeScene(const std::string& name) {
  const absl::StatusOr<HostPointer> host = Find(name);
  if (!host.ok()) return host.status();
  return SceneInfoToWire(name, (*host)->scene(), (*host)->CacheBytes());
}

absl::StatusOr<v1::UpdateSceneReply> LocalClient::UpdateScene(const v1::UpdateSceneRequest&) {
  return absl::FailedPreconditionError("--local: scenes of a server are edited, files by hand");
}

absl::Status LocalClient::UnloadScene(const std::string& name) {
  HostPointer removed;  // destroyed after the lock is released
  const std::lock_guard lock(mutex_);
  const auto found = hosts_.find(name);
  if (found == hosts_.end()) return absl::NotFoundError(absl::StrCat("no scene '", name, "'"));
  removed = std::move(found->second);
  hosts_.erase(found);
  return absl::OkStatus();
}

absl::StatusOr<Frame> LocalClient::RenderFrame(const std::string& scene,
                                               const FrameRequest& request,
                                               const std::string& camera_name,
                                               const FrameFormat& format,
                                               const Progress& progress) {
  const absl::StatusOr<HostPointer> host = Find(scene);
  if (!host.ok()) return host.status();
  FrameRequest resolved = request;
  if (!camera_name.empty()) {
    const Camera* camera = (*host)->scene().FindCamera(camera_name);
    if (camera == nullptr) {
      return absl::NotFoundError(absl::StrCat("no camera '", camera_name, "' in '", scene, "'"));
    }
    resolved.camera = *camera;
  }
  absl::StatusOr<Frame> frame = (*host)->RenderFrame(resolved, pool_, nullptr, progress);
  if (frame.ok()) frame->timing.render_ms = frame->stats.wall_ms;
  if (frame.ok() && !format.all_layers) {
    frame->object.clear();
    frame->source.clear();
    frame->verdict.clear();
    frame->depth.clear();
  }
  return frame;
}

absl::Status LocalClient::Fly(const std::string& scene, const std::vector<FrameRequest>& requests,
                              const FrameFormat& format,
                              const std::function<void(size_t index, Frame frame)>& on_frame) {
  for (size_t i = 0; i < requests.size(); ++i) {
    absl::StatusOr<Frame> frame = RenderFrame(scene, requests[i], "", format, nullptr);
    if (!frame.ok()) return frame.status();
    on_frame(i, *std::move(frame));
  }
  return absl::OkStatus();
}

std::unique_ptr<LiveFlight> LocalClient::Steer(const std::string& scene, const LiveOptions& options,
                                               LiveFlight::OnFrame on_frame) {
  class Flight final : public LiveFlight {
   public:
    Flight(LocalClient& client, std::string scene, const FrameFormat& format, OnFrame on_frame)
        : client_(client),
          scene_(std::move(scene)),
          format_(format),
          on_frame_(std::move(on_frame)) {}

    absl::StatusOr<uint64_t> Look(const FrameRequest& view) override {
      const std::lock_guard lock(mutex_);
      if (!status_.ok()) return status_;
      auto frame = client_.RenderFrame(scene_, view, "", format_, nullptr);
      status_ = frame.status();
      if (!frame.ok()) failed_.notify_all();
      if (!frame.ok()) return status_;
      on_frame_({.view = looked_, .frame = *std::move(frame)});
      return looked_++;
    }
    bool HasEndedBy(std::chrono::system_clock::time_point time) override {
      std::unique_lock lock(mutex_);
      return failed_.wait_until(lock, time, [this] { return !status_.ok(); });
    }
    absl::Status Land() override {
      const std::lock_guard lock(mutex_);
      return status_;
    }

   private:
    LocalClient& client_;
    const std::string scene_;
    const FrameFormat format_;
    const OnFrame on_frame_;
    std::mutex mutex_;
    std::condition_variable failed_;
    uint64_t looked_ = 0;  // guarded by mutex_, as is status_
    absl::Status status_;
  };
  return std::make_unique<Flight>(*this, scene, options.format, std::move(on_frame));
}

absl::StatusOr<RayBatch> LocalClient::TraceRays(const std::string& scene,
                                                const std::vector<Ray>& rays,
                                                const RenderOptions& options) {
  const absl::StatusOr<HostPointer> host = Find(scene);
  if (!host.ok()) return host.status();
  return (*host)->TraceRays(rays, options, pool_);
}

absl::StatusOr<v1::GetStatsReply> LocalClient::GetStats(const std::string& scene) {
  std::map<std::string, HostPointer> hosts;
  if (scene.empty()) {
    const std::lock_guard lock(mutex_);
    hosts = hosts_;
  } else {
    const absl::StatusOr<HostPointer> host = Find(scene);
    if (!host.ok()) return host.status();
    hosts[scene] = *host;
  }
  v1::GetStatsReply reply;
  for (const auto& [name, host] : hosts) *reply.add_scenes() = SceneStatsToWire(name, *host);
  reply.set_memory_budget_bytes(memory_bytes_);
  const std::chrono::duration<double> up = std::chrono::steady_clock::now() - started_;
  reply.set_uptime_s(up.count());
  reply.set_server_version("(in this process)");
  return reply;
}

absl::StatusOr<v1::GetLimitsReply> LocalClient::GetLimits() {
  return absl::UnimplementedError("--limits: a server has limits, --local has none to show");
}

absl::StatusOr<v1::TuneCacheReply> LocalClient::TuneCache(const v1::TuneCacheRequest& request) {
  const absl::StatusOr<HostPointer> host = Find(request.scene());
  if (!host.ok()) return host.status();
  if (request.has_policy()) {
    if (auto s = (*host)->SetPolicy(request.policy()); !s.ok()) return s;
  }
  v1::TuneCacheReply reply;
  reply.set_policy((*host)->policy());
  reply.set_memory_budget_bytes(memory_bytes_);
  return reply;
}

absl::StatusOr<v1::ExplainReply> LocalClient::Explain(const v1::ExplainRequest& request) {
  const absl::StatusOr<HostPointer> host = Find(request.scene());
  if (!host.ok()) return host.status();
  return ExplainToWire(request, RenderOptions().max_relative_error, **host);
}

}  // namespace linetree
