#include "server/backend.h"

#include <atomic>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/library/status.h"
#include "core/io/camera_path.h"
#include "core/io/scene_edit.h"
#include "core/io/trace_file.h"
#include "core/io/wire.h"
#include "core/io/wire_explain.h"
#include "core/io/wire_frame.h"
#include "core/policy/policies.h"
#include "core/store/data_folder.h"
#include "server/scene_root.h"
#include "server/wire_priority.h"

namespace linetree {
namespace {

absl::StatusOr<std::unique_ptr<SceneSource>> ParseText(const std::string& text,
                                                       const std::string& name, bool is_nff,
                                                       const SceneLimits& limits) {
  return is_nff ? ParseNff(text, name, limits) : ParseSceneText(text, name, limits);
}

// Null, and a line of the log, where cells cannot be kept: the server does without.
std::unique_ptr<CellStore> OpenCells(const ServerOptions& options,
                                     const std::shared_ptr<spdlog::logger>& log) {
  if (options.data_folder.empty()) return nullptr;
  auto store =
      CellStore::Open({.folder = CellFolder(options.data_folder), .max_bytes = options.store_bytes},
                      [log](const std::string& line) { log->warn("{}", line); });
  if (store.ok()) return *std::move(store);
  log->warn("{}; cells are not kept", std::string(store.status().message()));
  return nullptr;
}

}  // namespace

Backend::Backend(const ServerOptions& options, std::shared_ptr<spdlog::logger> log)
    : options_(options),
      log_(std::move(log)),
      recorder_(options.record_trace.empty() ? nullptr : std::make_unique<TraceRecorder>()),
      cells_(OpenCells(options, log_)),
      scenes_({.max_scenes = options.limits.max_scenes,
               .max_objects = options.limits.max_objects_in_all_scenes,
               .memory_bytes = options.memory_bytes},
              {options.policy, recorder_.get()}, cells_.get()),
      pool_(options.threads),
      frame_bytes_(options.limits.max_frame_bytes),
      flights_(options.limits.max_flights),
      sends_(options.max_stall_s),
      audit_({.share = options.audit_share, .max_waiting = options.limits.max_waiting_audits},
             [log = log_](const Violation& violation) {
               log->error("audit: an answer breaks its promise: {}", ToLine(violation));
             }),
      look_ahead_(renders_, pool_, options.prefetch),
      renders_(options.render_slots,
               {options.limits.max_waiting_renders, options.limits.max_waiting_rays},
               Busy("render slot")),
      loads_(1, {.max_waiting = options.limits.max_waiting_loads}, Busy("loader")) {}

absl::StatusOr<NamedHost> Backend::Keep(const std::string& name, const SceneSource& source,
                                        bool replace, std::optional<double> weight) {
  auto scene = BuildScene(source, options_.limits.scene);
  if (!scene.ok()) return scene.status();
  std::string content;
  if (!source.message().SerializeToString(&content)) {
    return absl::ResourceExhaustedError("scene: expected a message of less than 2 GiB");
  }
  return scenes_.Add(name, *std::move(scene), replace,
                     std::make_shared<const std::string>(std::move(content)), weight);
}

absl::Status Backend::LoadSceneFiles() {
  for (const SceneFile& file : options_.scenes) {
    std::optional<double> weight;
    for (const SceneWeight& of : options_.scene_weights) {
      if (of.name == file.name) weight = of.weight;
    }
    auto source = ReadSceneFile(file.path, options_.limits.scene);
    if (!source.ok()) return source.status();
    auto added = Keep(file.name, **source, /*replace=*/false, weight);
    if (!added.ok()) return added.status();
    const Scene& scene = added->host->scene();
    log_->info("scene {} from {}: {} objects, version {}", file.name, file.path,
               scene.objects.size(), scene.version);
    if (const uint64_t cells = added->pages ? added->pages->counts().cells_restored : 0) {
      log_->info("scene {}: {} cells from the disk", file.name, cells);
    }
  }
  return absl::OkStatus();
}

absl::Status Backend::WarmUp(const std::function<void()>& ready) {
  std::vector<std::pair<NamedHost, std::vector<FrameRequest>>> all;
  for (const SceneFile& file : options_.warm_ups) {
    const auto path = LoadCameraPath(file.path);
    if (!path.ok()) return path.status();
    const auto cameras = SampleCameraPath(*path, path->frames);
    if (!cameras.ok()) return cameras.status();
    std::vector<FrameRequest> frames;
    for (const Camera& camera : *cameras) {
      frames.push_back({.camera = camera, .options = options_.defaults});
    }
    auto scene = scenes_.Find(file.name, "--warm-up");
    if (!scene.ok()) continue;  // a client has unloaded it
    all.emplace_back(*std::move(scene), std::move(frames));
  }
  if (all.empty()) ready();
  const auto left = std::make_shared<std::atomic<size_t>>(all.size());
  for (auto& [scene, frames] : all) {
    warm_ups_.Start(scene, std::move(frames), [left, ready, log = log_, name = scene.name] {
      log->info("scene {} is warm", name);
      if (--*left == 0) ready();
    });
  }
  return absl::OkStatus();
}

void Backend::SaveTrace() const {
  if (recorder_ == nullptr) return;
  const Trace trace = recorder_->Take();
  if (auto status = WriteTrace(trace, options_.record_trace); !status.ok()) {
    return log_->error("--record-trace: {}", std::string(status.message()));
  }
  log_->info("{}: {} uses recorded", options_.record_trace, trace.size());
  if (recorder_->dropped() > 0) {
    log_->warn("{}: {} more found no room", options_.record_trace, recorder_->dropped());
  }
}

absl::StatusOr<std::vector<FrameRequest>> Backend::WarmUpFrames(const v1::WarmUp& warm_up) const {
  auto path = CameraPathFromMessage(warm_up.path(), "warm_up.path");
  if (!path.ok()) return path.status();
  const uint64_t count = warm_up.frames() > 0 ? warm_up.frames() : uint64_t(path->frames);
  if (count > options_.limits.max_warm_up_frames) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "warm_up.frames: expected at most ", options_.limits.max_warm_up_frames, ", got ", count));
  }
  auto options = RenderOptionsFromWire(warm_up.options(), options_.defaults, "warm_up.");
  if (!options.ok()) return options.status();
  FrameRequest frame;
  frame.options = *options;
  const auto side = [](uint32_t asked, int usual) { return asked > 0 ? asked : usual; };
  const int64_t width = side(warm_up.width(), frame.width);
  const int64_t height = side(warm_up.height(), frame.height);
  const auto size = ValidateSize(width, height, options_.limits.render);
  if (!size.ok()) return absl::Status(size.code(), absl::StrCat("warm_up.", size.message()));
  frame.width = static_cast<int>(width);
  frame.height = static_cast<int>(height);
  const auto cameras = SampleCameraPath(*path, static_cast<int>(count));
  if (!cameras.ok()) {
    return absl::InvalidArgumentError(absl::StrCat("warm_up.path: ", cameras.status().message()));
  }
  std::vector<FrameRequest> frames;
  for (const Camera& camera : *cameras) {
    frames.push_back(frame);
    frames.back().camera = camera;
  }
  return frames;
}

absl::StatusOr<std::unique_ptr<SceneSource>> Backend::SourceOf(v1::LoadSceneRequest request) const {
  const SceneLimits& limits = options_.limits.scene;
  switch (request.content_case()) {
    case v1::LoadSceneRequest::kScene:
      return SceneFromMessage(std::move(*request.mutable_scene()));
    case v1::LoadSceneRequest::kText:
      return ParseText(request.text(), request.name(),
                       request.format() == v1::LoadSceneRequest::NFF, limits);
    case v1::LoadSceneRequest::kFile: {
      if (options_.scene_root.empty()) {
        return absl::PermissionDeniedError(
            "file: this server loads no files for clients; send the scene");
      }
      const auto text =
          ReadFileBelow(options_.scene_root, request.file(), limits.max_file_bytes, "file");
      if (!text.ok()) return text.status();
      return ParseText(*text, request.file(), absl::EndsWithIgnoreCase(request.file(), ".nff"),
                       limits);
    }
    case v1::LoadSceneRequest::CONTENT_NOT_SET:
      break;
  }
  return absl::InvalidArgumentError("content: expected one of scene, text and file");
}

absl::StatusOr<v1::SceneInfo> Backend::LoadScene(v1::LoadSceneRequest request) {
  if (auto status = ValidateSceneName(request.name(), "name"); !status.ok()) return status;
  if (!v1::LoadSceneRequest::TextFormat_IsValid(request.format())) {
    return absl::InvalidArgumentError(
        absl::StrCat("format: expected TEXTPROTO or NFF, got ", request.format()));
  }
  std::optional<double> weight;
  if (request.has_memory_weight()) weight = request.memory_weight();
  if (weight && !(*weight >= kMinSceneWeight && *weight <= kMaxSceneWeight)) {
    return absl::InvalidArgumentError(absl::StrCat("memory_weight: expected a number in [",
                                                   kMinSceneWeight, ", ", kMaxSceneWeight,
                                                   "], got ", *weight));
  }
  std::vector<FrameRequest> warm_up;
  if (request.has_warm_up()) {
    auto frames = WarmUpFrames(request.warm_up());
    if (!frames.ok()) return frames.status();
    warm_up = *std::move(frames);
  }
  const std::string name = request.name();
  const bool replace = request.replace();
  auto source = SourceOf(std::move(request));
  if (!source.ok()) return source.status();
  auto added = Keep(name, **source, replace, weight);
  if (!added.ok()) return added.status();
  const Scene& loaded = added->host->scene();
  log_->info("scene {} loaded: {} objects, version {}", name, loaded.objects.size(),
             loaded.version);
  if (!warm_up.empty()) warm_ups_.Start(*added, std::move(warm_up));
  return InfoOf(*added);
}

v1::SceneInfo Backend::InfoOf(const NamedHost& scene) const {
  v1::SceneInfo info = SceneInfoToWire(scene.name, scene.host->scene(), scene.host->CacheBytes());
  info.set_memory_budget_bytes(scene.memory_bytes);
  info.set_warm_up_frames_left(warm_ups_.FramesLeft(scene.name));
  return info;
}

absl::StatusOr<v1::UpdateSceneReply> Backend::UpdateScene(const v1::UpdateSceneRequest& request,
                                                          const CancelToken& cancel) {
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
  if (auto status = ApplyEdits(request.edits(), message, &cancel); !status.ok()) return status;
  const uint64_t max_bytes = options_.limits.scene.max_file_bytes;
  if (message.ByteSizeLong() > max_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "edits: expected a scene of at most ", max_bytes, " bytes, got ", message.ByteSizeLong()));
  }
  auto added = Keep(request.scene(), *SceneFromMessage(std::move(message)), /*replace=*/true);
  if (!added.ok()) return added.status();
  SceneHost& host = *added->host;
  v1::UpdateSceneReply reply;
  *reply.mutable_info() = InfoOf(*added);
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
  for (const NamedHost& scene : scenes_.All()) *reply.add_scenes() = InfoOf(scene);
  return reply;
}

absl::StatusOr<v1::SceneInfo> Backend::DescribeScene(
    const v1::DescribeSceneRequest& request) const {
  auto scene = scenes_.Find(request.scene(), "scene");
  if (!scene.ok()) return scene.status();
  return InfoOf(*scene);
}

absl::StatusOr<v1::UnloadSceneReply> Backend::UnloadScene(const v1::UnloadSceneRequest& request) {
  if (auto status = scenes_.Remove(request.scene(), "scene"); !status.ok()) return status;
  log_->info("scene {} unloaded", request.scene());
  return v1::UnloadSceneReply();
}

absl::StatusOr<v1::TuneCacheReply> Backend::TuneCache(const v1::TuneCacheRequest& request) const {
  auto scene = scenes_.Find(request.scene(), "scene");
  if (!scene.ok()) return scene.status();
  if (request.has_policy()) {
    if (request.policy().empty()) {
      return absl::InvalidArgumentError(
          absl::StrCat("policy: expected one of ", PolicyNames(), ", got none"));
    }
    if (auto status = scene->host->SetPolicy(request.policy()); !status.ok()) {
      return absl::Status(status.code(), absl::StrCat("policy: ", status.message()));
    }
    log_->info("scene {} evicts by {}", scene->name, request.policy());
  }
  v1::TuneCacheReply reply;
  reply.set_policy(scene->host->policy());
  reply.set_memory_budget_bytes(scene->memory_bytes);
  return reply;
}

absl::StatusOr<v1::ExplainReply> Backend::Explain(const v1::ExplainRequest& request) const {
  auto scene = scenes_.Find(request.scene(), "scene");
  if (!scene.ok()) return scene.status();
  return ExplainToWire(request, options_.defaults.max_relative_error, *scene->host);
}

absl::StatusOr<v1::TraceRaysReply> Backend::TraceRays(const v1::TraceRaysRequest& request,
                                                      const CancelToken& cancel,
                                                      FrameTimer& timer) {
  const auto priority = PriorityFromWire(request.priority(), Priority::kBatch, "priority");
  if (!priority.ok()) return priority.status();
  auto scene = scenes_.Find(request.scene(), "scene");
  if (!scene.ok()) return scene.status();
  auto options = RenderOptionsFromWire(request.options(), options_.defaults, "");
  if (!options.ok()) return options.status();
  const std::vector<Ray> rays = RaysFromWire(request);
  const LookAhead::Asked asked(look_ahead_);
  const auto batch = scene->host->TraceRays(rays, *options, pool_, &cancel);
  if (!batch.ok()) return batch.status();
  scene->answers->Add(*batch);
  audit_.Offer({scene->name, scene->host, scene->audit}, rays, *options, *batch);
  timer.Enter(FrameTimer::Stage::kEncode);
  v1::TraceRaysReply reply = RayBatchToWire(*batch, scene->host->scene().version);
  reply.set_max_relative_error(options->max_relative_error);
  timer.Enter(FrameTimer::Stage::kElsewhere);
  return reply;
}

absl::StatusOr<Backend::PreparedFrame> Backend::PrepareFrame(const v1::RenderFrameRequest& request,
                                                             absl::string_view path) {
  const auto priority =
      PriorityFromWire(request.priority(), Priority::kInteractive, absl::StrCat(path, "priority"));
  if (!priority.ok()) return priority.status();
  auto scene = scenes_.Find(request.scene(), absl::StrCat(path, "scene"));
  if (!scene.ok()) return scene.status();
  auto frame = FrameRequestFromWire(request, scene->host->scene(), options_.defaults,
                                    options_.limits.render, path);
  if (!frame.ok()) return frame.status();
  const auto format = FrameFormatFromWire(request, path);
  if (!format.ok()) return format.status();
  const auto pixels = static_cast<uint64_t>(frame->width) * static_cast<uint64_t>(frame->height);
  auto memory =
      frame_bytes_.Take(pixels * (kFrameBytesPerPixel + FileBytesPerPixel(format->codec)));
  if (!memory) return Busy("memory for frames");
  return PreparedFrame{*priority, *std::move(scene), *std::move(frame), *format,
                       *std::move(memory)};
}

absl::StatusOr<Frame> Backend::Render(const PreparedFrame& frame, const CancelToken& cancel) {
  const NamedHost& scene = frame.scene;
  const LookAhead::Asked asked(look_ahead_);
  auto answer = scene.host->RenderFrame(frame.request, pool_, &cancel);
  if (answer.ok()) {
    scene.answers->Add(*answer);
    audit_.Offer({scene.name, scene.host, scene.audit}, frame.request.options, *answer);
  }
  return answer;
}

Load Backend::CurrentLoad() const {
  return {.waiting_renders = {renders_.waiting(Priority::kInteractive),
                              renders_.waiting(Priority::kBatch),
                              renders_.waiting(Priority::kBackground)},
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
