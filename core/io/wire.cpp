#include "core/io/wire.h"

#include <algorithm>
#include <limits>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "core/io/wire_frame.h"

namespace linetree {
namespace {

Vec3d FromWire(const v1::Vec3& v) { return {v.x(), v.y(), v.z()}; }

void ToWire(const Vec3d& v, v1::Vec3* message) {
  message->set_x(v.x);
  message->set_y(v.y);
  message->set_z(v.z);
}

// The same error with `path` in front of the field that it names.
absl::Status Prefixed(absl::string_view path, const absl::Status& status) {
  return {status.code(), absl::StrCat(path, status.message())};
}

absl::Status CheckEnum(bool valid, absl::string_view path, absl::string_view field, int value) {
  if (valid) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(path, field, ": expected one of the values in service.proto, got ", value));
}

}  // namespace

std::string Quoted(absl::string_view text) {
  constexpr size_t kLongest = 80;
  const bool cut = text.size() > kLongest;
  return absl::StrCat("'", absl::CHexEscape(text.substr(0, kLongest)), cut ? "...'" : "'");
}

absl::Status ValidateSceneName(absl::string_view name, absl::string_view path) {
  const bool good = !name.empty() && name.size() <= kMaxSceneName &&
                    std::all_of(name.begin(), name.end(), [](char c) {
                      return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '_' ||
                             c == '.' || c == '-';
                    });
  if (good) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(path, ": expected 1 to ", kMaxSceneName,
                                                 " of [A-Za-z0-9_.-], got ", Quoted(name)));
}

v1::Camera CameraToWire(const Camera& camera) {
  v1::Camera message;
  message.set_name(camera.name);
  ToWire(camera.eye, message.mutable_eye());
  ToWire(camera.look_at, message.mutable_look_at());
  ToWire(camera.up, message.mutable_up());
  message.set_fov_deg(camera.fov_deg);
  return message;
}

Camera CameraFromWire(const v1::Camera& message) {
  Camera camera;
  camera.name = message.name();
  camera.eye = FromWire(message.eye());
  camera.look_at = FromWire(message.look_at());
  if (message.has_up()) camera.up = FromWire(message.up());
  if (message.has_fov_deg()) camera.fov_deg = message.fov_deg();
  return camera;
}

v1::RenderOptions RenderOptionsToWire(const RenderOptions& options) {
  v1::RenderOptions message;
  message.set_mode(options.mode == Mode::kClassical ? v1::CLASSICAL : v1::CACHED);
  message.set_judge(options.judge == JudgeKind::kCertified ? v1::JUDGE_CERTIFIED : v1::PAPER);
  message.set_max_relative_error(options.max_relative_error);
  message.set_max_depth(static_cast<uint32_t>(options.limits.max_depth));
  message.set_min_weight(options.limits.min_weight);
  message.set_lanes(options.lanes == Lanes::kScalar ? v1::LANES_SCALAR : v1::LANES_SIMD);
  return message;
}

absl::StatusOr<RenderOptions> RenderOptionsFromWire(const v1::RenderOptions& message,
                                                    const RenderOptions& defaults,
                                                    absl::string_view path) {
  auto status = CheckEnum(v1::Mode_IsValid(message.mode()), path, "options.mode", message.mode());
  if (!status.ok()) return status;
  status = CheckEnum(v1::Judge_IsValid(message.judge()), path, "options.judge", message.judge());
  if (!status.ok()) return status;

  status = CheckEnum(v1::Lanes_IsValid(message.lanes()), path, "options.lanes", message.lanes());
  if (!status.ok()) return status;

  RenderOptions options = defaults;
  if (message.mode() == v1::CACHED) options.mode = Mode::kCached;
  if (message.mode() == v1::CLASSICAL) options.mode = Mode::kClassical;
  if (message.judge() == v1::PAPER) options.judge = JudgeKind::kPaper;
  if (message.judge() == v1::JUDGE_CERTIFIED) options.judge = JudgeKind::kCertified;
  if (message.has_max_relative_error()) options.max_relative_error = message.max_relative_error();
  if (message.has_max_depth()) {
    constexpr uint32_t kLargest = std::numeric_limits<int>::max();
    options.limits.max_depth = static_cast<int>(std::min(message.max_depth(), kLargest));
  }
  if (message.has_min_weight()) options.limits.min_weight = message.min_weight();
  if (message.lanes() == v1::LANES_SIMD) options.lanes = Lanes::kSimd;
  if (message.lanes() == v1::LANES_SCALAR) options.lanes = Lanes::kScalar;
  status = ValidateOptions(options);
  if (!status.ok()) return Prefixed(path, status);
  return options;
}

v1::Sampling SamplingToWire(const Sampling& sampling) {
  v1::Sampling message;
  message.set_samples(static_cast<uint32_t>(sampling.samples));
  message.set_pattern(sampling.pattern == SamplePattern::kJittered ? v1::SAMPLES_JITTERED
                                                                   : v1::SAMPLES_REGULAR);
  message.set_seed(sampling.seed);
  return message;
}

absl::StatusOr<Sampling> SamplingFromWire(const v1::Sampling& message, absl::string_view path) {
  auto status = CheckEnum(v1::SamplePattern_IsValid(message.pattern()), path, "sampling.pattern",
                          message.pattern());
  if (!status.ok()) return status;
  Sampling sampling;
  constexpr uint32_t kLargest = std::numeric_limits<int>::max();
  if (message.samples() > 0) {
    sampling.samples = static_cast<int>(std::min(message.samples(), kLargest));
  }
  if (message.pattern() == v1::SAMPLES_JITTERED) sampling.pattern = SamplePattern::kJittered;
  sampling.seed = message.seed();
  return sampling;
}

v1::RenderFrameRequest FrameRequestToWire(const std::string& scene, const FrameRequest& request,
                                          const std::string& camera_name,
                                          const FrameFormat& format) {
  v1::RenderFrameRequest message;
  message.set_scene(scene);
  if (camera_name.empty()) {
    *message.mutable_camera() = CameraToWire(request.camera);
  } else {
    message.set_camera_name(camera_name);
  }
  message.set_width(static_cast<uint32_t>(request.width));
  message.set_height(static_cast<uint32_t>(request.height));
  *message.mutable_options() = RenderOptionsToWire(request.options);
  FrameFormatToWire(format, &message);
  *message.mutable_sampling() = SamplingToWire(request.sampling);
  return message;
}

absl::StatusOr<FrameRequest> FrameRequestFromWire(const v1::RenderFrameRequest& message,
                                                  const Scene& scene, const RenderOptions& defaults,
                                                  const RenderLimits& limits,
                                                  absl::string_view path) {
  auto status = ValidateSize(message.width(), message.height(), limits);
  if (!status.ok()) return Prefixed(path, status);
  FrameRequest request;
  request.width = static_cast<int>(message.width());
  request.height = static_cast<int>(message.height());

  if (message.has_camera()) {
    request.camera = CameraFromWire(message.camera());
    status = ValidateCamera(request.camera);
    if (!status.ok()) return Prefixed(path, status);
  } else {
    const Camera* camera = scene.FindCamera(message.camera_name());
    if (camera == nullptr) {
      return absl::NotFoundError(absl::StrCat(path, "camera_name: expected one of the scene's ",
                                              scene.cameras.size(), " cameras, got ",
                                              Quoted(message.camera_name())));
    }
    request.camera = *camera;
  }
  auto options = RenderOptionsFromWire(message.options(), defaults, path);
  if (!options.ok()) return options.status();
  request.options = *options;
  auto sampling = SamplingFromWire(message.sampling(), path);
  if (!sampling.ok()) return sampling.status();
  request.sampling = *sampling;
  status = ValidateSamples(request.sampling, request.width, request.height, limits);
  if (!status.ok()) return Prefixed(path, status);
  return request;
}

v1::TraceRaysRequest RaysToWire(const std::string& scene, const std::vector<Ray>& rays,
                                const RenderOptions& options) {
  v1::TraceRaysRequest message;
  message.set_scene(scene);
  *message.mutable_options() = RenderOptionsToWire(options);
  message.mutable_rays()->Reserve(static_cast<int>(rays.size()));
  for (const Ray& ray : rays) {
    v1::Ray* r = message.add_rays();
    ToWire(ray.origin, r->mutable_origin());
    ToWire(ray.direction, r->mutable_direction());
  }
  return message;
}

std::vector<Ray> RaysFromWire(const v1::TraceRaysRequest& message) {
  std::vector<Ray> rays;
  rays.reserve(static_cast<size_t>(message.rays_size()));
  for (const v1::Ray& ray : message.rays()) {
    rays.push_back({FromWire(ray.origin()), FromWire(ray.direction())});
  }
  return rays;
}

v1::TraceRaysReply RayBatchToWire(const RayBatch& batch, const SceneVersion& version) {
  v1::TraceRaysReply reply;
  reply.set_scene_version(version);
  *reply.mutable_stats() = FrameStatsToWire(batch.stats, 0, 0);
  reply.set_lane_rounding(batch.lane_rounding);
  reply.mutable_answers()->Reserve(static_cast<int>(batch.answers.size()));
  for (const RayAnswer& answer : batch.answers) {
    v1::RayAnswer* a = reply.add_answers();
    a->mutable_radiance()->set_r(answer.radiance.r);
    a->mutable_radiance()->set_g(answer.radiance.g);
    a->mutable_radiance()->set_b(answer.radiance.b);
    a->set_source(static_cast<v1::Source>(answer.source));
    a->set_verdict(static_cast<v1::Verdict>(answer.verdict));
    a->set_object(answer.object);
    a->set_depth(answer.depth);
  }
  return reply;
}

absl::StatusOr<RayBatch> RayBatchFromWire(const v1::TraceRaysReply& message) {
  RayBatch batch;
  batch.stats = FrameStatsFromWire(message.stats());
  batch.lane_rounding = message.lane_rounding();
  batch.answers.reserve(static_cast<size_t>(message.answers_size()));
  for (const v1::RayAnswer& a : message.answers()) {
    if (!v1::Source_IsValid(a.source()) || !v1::Verdict_IsValid(a.verdict())) {
      return absl::DataLossError(
          absl::StrCat("answers[", batch.answers.size(), "]: unknown source or verdict"));
    }
    batch.answers.push_back({{a.radiance().r(), a.radiance().g(), a.radiance().b()},
                             static_cast<Source>(a.source()),
                             static_cast<Verdict>(a.verdict()),
                             a.object(),
                             a.depth()});
  }
  return batch;
}

v1::SceneInfo SceneInfoToWire(const std::string& name, const Scene& scene, uint64_t cache_bytes) {
  v1::SceneInfo info;
  info.set_name(name);
  info.set_scene_version(scene.version);
  info.set_description(scene.description);
  info.set_objects(scene.objects.size());
  info.set_materials(scene.materials.size());
  info.set_lights(scene.lights.size());
  for (const Camera& camera : scene.cameras) *info.add_cameras() = CameraToWire(camera);
  const Box3 bounds = scene.WorldBounds();
  ToWire(bounds.min, info.mutable_bounds_min());
  ToWire(bounds.max, info.mutable_bounds_max());
  info.set_cache_bytes(cache_bytes);
  return info;
}

}  // namespace linetree
