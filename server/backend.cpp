#include "server/backend.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "client/library/status.h"
#include "core/io/scene_edit.h"
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

absl::StatusOr<NamedHost> Backend::Keep(const std::string& name, const SceneSource& source,
                                        bool replace) {
  auto scene = BuildScene(source, options_.limits.scene);
  if (!scene.ok()) return scene.status();
  return scenes_.Add(name, *std::move(scene), replace,
                     std::make_shared<const std::string>(source.message().SerializeAsString()));
}

absl::Status Backend::LoadSceneFiles() {
  for (const SceneFile& file : options_.scenes) {
    auto source = ReadSceneFile(file.path, options_.limits.scene);
    if (!source.ok()) return source.status();
    auto added = Keep(file.name, **source, /*replace=*/false);
    if (!added.ok()) return added.status();
    const Scene& scene = added->host->scene();
    log_->info("scene {} from {}: {} objects, version {}", file.name, file.path,
               scene.objects.size(), scene.version);
  }
  return absl::OkStatus();
}

absl::StatusOr<std::unique_ptr<SceneSource>> Backend::SourceOf(v1::LoadSceneRequest request) const {
  const SceneLimits& limits = options_.limits.scene;
  switch (request.content_case()) {
    case v1::LoadSceneRequest::kScene:
      return SceneFromMessage(std::move(*request.mutable_scene()));
    case v1::LoadSceneRequest::kText:
      return request.format() == v1::LoadSceneRequest::NFF
                 ? ParseNff(request.text(), request.name(), limits)
                 : ParseSceneText(request.text(), request.name(), limits);
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
  auto source = SourceOf(std::move(request));
  if (!source.ok()) return source.status();
  auto added = Keep(name, **source, replace);
  if (!added.ok()) return added.status();
  SceneHost& host = *added->host;
  log_->info("scene {} loaded: {} objects, version {}", name, host.scene().objects.size(),
             host.scene().version);
  return SceneInfoToWire(name, host.scene(), host.CacheBytes());
}

absl::StatusOr<v1::UpdateSceneReply> Backend::UpdateScene(const v1::UpdateSceneRequest& request) {
  auto former = scenes_.Find(request.scene(), "scene");
  if (!former.ok()) return former.status();
  const SceneVersion& version = former->host->scene().version;
  if (!request.expected_version().empty() && request.expected_version() != version) {
    return absl::FailedPreconditionError(absl::StrCat("expected_version: the scene has version ",
                                                      version, ", not ",
                                                      Quoted(request.expected_version())));
  }
  v1::Scene message;
  if (!message.ParseFromString(*former->content)) {
    return absl::InternalError("the scene's message cannot be read back");
  }
  if (auto status = ApplyEdits(request.edits(), message); !status.ok()) return status;
  auto added = Keep(request.scene(), *SceneFromMessage(std::move(message)), /*replace=*/true);
  if (!added.ok()) return added.status();
  SceneHost& host = *added->host;
  v1::UpdateSceneReply reply;
  *reply.mutable_info() = SceneInfoToWire(added->name, host.scene(), host.CacheBytes());
  if (&host != former->host.get()) {
    reply.set_cells_kept(added->adopted.kept);
    reply.set_cells_dropped(added->adopted.dropped);
    reply.set_find_ms(added->adopt_ms);
  }
  log_->info("scene {} edited: {} objects, version {}, {} cells kept, {} dropped", added->name,
             host.scene().objects.size(), host.scene().version, reply.cells_kept(),
             reply.cells_dropped());
  return reply;
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
