#include "server/backend.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "client/library/status.h"
#include "core/io/load_scene.h"
#include "core/io/wire.h"
#include "server/limit_list.h"

namespace linetree {

Backend::Backend(const ServerOptions& options, std::shared_ptr<spdlog::logger> log)
    : options_(options),
      log_(std::move(log)),
      scenes_({.max_scenes = options.limits.max_scenes,
               .max_objects = options.limits.max_objects_in_all_scenes,
               .memory_bytes = options.memory_bytes}),
      pool_(options.threads),
      frame_bytes_(options.limits.max_frame_bytes),
      flights_(options.limits.max_flights),
      audit_({.share = options.audit_share, .max_waiting = options.limits.max_waiting_audits},
             [log = log_](const Violation& violation) {
               log->error("audit: an answer breaks its promise: {}", ToLine(violation));
             }),
      renders_(options.render_slots, options.limits.max_waiting_renders),
      loads_(1, options.limits.max_waiting_loads) {}

absl::Status Backend::LoadSceneFiles() {
  for (const SceneFile& file : options_.scenes) {
    auto scene = LoadSceneFile(file.path, options_.limits.scene);
    if (!scene.ok()) return scene.status();
    auto added = scenes_.Add(file.name, *scene, /*replace=*/false);
    if (!added.ok()) return added.status();
    log_->info("scene {} from {}: {} objects, version {}", file.name, file.path,
               (*scene)->objects.size(), (*scene)->version);
  }
  return absl::OkStatus();
}

absl::StatusOr<std::shared_ptr<const Scene>> Backend::BuildFrom(
    v1::LoadSceneRequest request) const {
  const SceneLimits& limits = options_.limits.scene;
  switch (request.content_case()) {
    case v1::LoadSceneRequest::kScene:
      return BuildScene(*SceneFromMessage(std::move(*request.mutable_scene())), limits);
    case v1::LoadSceneRequest::kText: {
      auto source = request.format() == v1::LoadSceneRequest::NFF
                        ? ParseNff(request.text(), request.name(), limits)
                        : ParseSceneText(request.text(), request.name(), limits);
      if (!source.ok()) return source.status();
      return BuildScene(**source, limits);
    }
    case v1::LoadSceneRequest::CONTENT_NOT_SET:
      break;
  }
  return absl::InvalidArgumentError("content: expected either scene or text");
}

absl::StatusOr<v1::SceneInfo> Backend::LoadScene(v1::LoadSceneRequest request) {
  if (auto status = ValidateSceneName(request.name(), "name"); !status.ok()) return status;
  if (!v1::LoadSceneRequest::TextFormat_IsValid(request.format())) {
    return absl::InvalidArgumentError(
        absl::StrCat("format: expected TEXTPROTO or NFF, got ", request.format()));
  }
  const std::string name = request.name();
  const bool replace = request.replace();
  auto scene = BuildFrom(std::move(request));
  if (!scene.ok()) return scene.status();
  auto added = scenes_.Add(name, *std::move(scene), replace);
  if (!added.ok()) return added.status();
  SceneHost& host = *added->host;
  log_->info("scene {} loaded: {} objects, version {}", name, host.scene().objects.size(),
             host.scene().version);
  return SceneInfoToWire(name, host.scene(), host.CacheBytes());
}

v1::ListScenesReply Backend::ListScenes() const {
  v1::ListScenesReply reply;
  for (const NamedHost& scene : scenes_.All()) {
    *reply.add_scenes() =
        SceneInfoToWire(scene.name, scene.host->scene(), scene.host->CacheBytes());
  }
  return reply;
}

absl::StatusOr<v1::SceneInfo> Backend::DescribeScene(
    const v1::DescribeSceneRequest& request) const {
  auto scene = scenes_.Find(request.scene(), "scene");
  if (!scene.ok()) return scene.status();
  return SceneInfoToWire(scene->name, scene->host->scene(), scene->host->CacheBytes());
}

absl::StatusOr<v1::UnloadSceneReply> Backend::UnloadScene(const v1::UnloadSceneRequest& request) {
  if (auto status = scenes_.Remove(request.scene(), "scene"); !status.ok()) return status;
  log_->info("scene {} unloaded", request.scene());
  return v1::UnloadSceneReply();
}

v1::GetStatsReply::SceneStats Backend::StatsOf(const NamedHost& scene) {
  v1::GetStatsReply::SceneStats stats = SceneStatsToWire(scene.name, *scene.host);
  *stats.mutable_audit() = AuditStatsToWire(scene.audit->values());
  AnswerCountsToWire(scene.answers->values(), scene.host->scene(), &stats);
  return stats;
}

v1::GetLimitsReply Backend::GetLimits() const {
  v1::GetLimitsReply reply;
  for (const NamedLimit& limit : ListLimits(options_.limits)) {
    v1::GetLimitsReply::Limit* out = reply.add_limits();
    out->set_name(std::string(limit.name));
    out->set_value(limit.value);
    out->set_bounds(std::string(limit.bounds));
  }
  return reply;
}

absl::StatusOr<v1::GetStatsReply> Backend::GetStats(const v1::GetStatsRequest& request) const {
  v1::GetStatsReply reply;
  if (request.scene().empty()) {
    for (const NamedHost& scene : scenes_.All()) {
      *reply.add_scenes() = StatsOf(scene);
    }
  } else {
    auto scene = scenes_.Find(request.scene(), "scene");
    if (!scene.ok()) return scene.status();
    *reply.add_scenes() = StatsOf(*scene);
  }
  reply.set_memory_budget_bytes(options_.memory_bytes);
  const std::chrono::duration<double> up = std::chrono::steady_clock::now() - started_;
  reply.set_uptime_s(up.count());
  reply.set_server_version(LINETREE_VERSION);
  reply.set_audit_share(options_.audit_share);
  return reply;
}

absl::StatusOr<v1::TraceRaysReply> Backend::TraceRays(const v1::TraceRaysRequest& request,
                                                      const CancelToken& cancel) {
  auto scene = scenes_.Find(request.scene(), "scene");
  if (!scene.ok()) return scene.status();
  auto options = RenderOptionsFromWire(request.options(), options_.defaults, "");
  if (!options.ok()) return options.status();
  const std::vector<Ray> rays = RaysFromWire(request);
  const auto batch = scene->host->TraceRays(rays, *options, pool_, &cancel);
  if (!batch.ok()) return batch.status();
  scene->answers->Add(*batch);
  audit_.Offer({scene->name, scene->host, scene->audit}, rays, *options, *batch);
  return RayBatchToWire(*batch, scene->host->scene().version);
}

absl::StatusOr<Backend::PreparedFrame> Backend::PrepareFrame(const v1::RenderFrameRequest& request,
                                                             absl::string_view path) {
  auto scene = scenes_.Find(request.scene(), absl::StrCat(path, "scene"));
  if (!scene.ok()) return scene.status();
  auto frame = FrameRequestFromWire(request, scene->host->scene(), options_.defaults,
                                    options_.limits.render, path);
  if (!frame.ok()) return frame.status();
  const auto pixels = static_cast<uint64_t>(frame->width) * static_cast<uint64_t>(frame->height);
  auto memory = frame_bytes_.Take(pixels * kFrameBytesPerPixel);
  if (!memory) return Busy("memory for frames");
  return PreparedFrame{*std::move(scene), *std::move(frame), request.all_layers(),
                       *std::move(memory)};
}

absl::StatusOr<Frame> Backend::Render(const PreparedFrame& frame, const CancelToken& cancel) {
  const NamedHost& scene = frame.scene;
  auto answer = scene.host->RenderFrame(frame.request, pool_, &cancel);
  if (answer.ok()) {
    scene.answers->Add(*answer);
    audit_.Offer({scene.name, scene.host, scene.audit}, frame.request.options, *answer);
  }
  return answer;
}

Load Backend::CurrentLoad() const {
  return {.waiting_renders = renders_.waiting(),
          .waiting_loads = loads_.waiting(),
          .open_flights = options_.limits.max_flights - flights_.free()};
}

absl::Status Backend::Busy(absl::string_view what) const {
  const auto delay_ms = options_.limits.retry_after_ms;
  return WithRetryAfter(
      absl::ResourceExhaustedError(absl::StrCat("the server has no ", what, " left; try again in ",
                                                delay_ms.count(), " ms")),
      delay_ms);
}

}  // namespace linetree
