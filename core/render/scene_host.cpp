#include "core/render/scene_host.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/render/frame_blocks.h"
#include "core/render/ray_blocks.h"
#include "core/render/sample_mean.h"
#include "core/render/sample_rays.h"

namespace linetree {
namespace {

class Stopwatch {
 public:
  double Ms() const {
    const auto elapsed = std::chrono::steady_clock::now() - begin_;
    return std::chrono::duration<double, std::milli>(elapsed).count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

// Rows of a band together hold about as many rays as one batch of AnswerRays, so rays and answers
// of a whole large picture never exist at once.
int RowsPerBand(int width) { return std::max(1, (1 << 18) / width); }

void StoreAnswers(std::span<const RayAnswer> answers, size_t first, Frame& frame) {
  for (size_t i = 0; i < answers.size(); ++i) {
    const RayAnswer& answer = answers[i];
    const size_t p = first + i;
    for (int c = 0; c < 3; ++c) {
      frame.radiance[3 * p + static_cast<size_t>(c)] = static_cast<float>(answer.radiance[c]);
    }
    frame.object[p] = answer.object;
    frame.source[p] = answer.source;
    frame.verdict[p] = answer.verdict;
    frame.depth[p] = static_cast<float>(answer.depth);
  }
}

Frame EmptyFrame(const Scene& scene, const FrameRequest& request) {
  Frame frame;
  frame.width = request.width;
  frame.height = request.height;
  const size_t pixels = static_cast<size_t>(request.width) * static_cast<size_t>(request.height);
  frame.radiance.resize(3 * pixels);
  frame.object.resize(pixels);
  frame.source.resize(pixels);
  frame.verdict.resize(pixels);
  frame.depth.resize(pixels);
  frame.camera = request.camera;
  frame.sampling = request.sampling;
  frame.max_relative_error = request.options.max_relative_error;
  frame.white = scene.white;
  frame.scene_version = scene.version;
  return frame;
}

// How the budget is shared between the caches of a scene.
struct MemoryShares {
  explicit MemoryShares(uint64_t memory_bytes) {
    const auto share = [&](double part) {
      return static_cast<uint64_t>(part * static_cast<double>(memory_bytes));
    };
    surfaces = share(kSurfaceShare);
    paths = share(kPathShare);
    radiance = memory_bytes - surfaces - paths;
  }
  uint64_t surfaces, paths, radiance;
};

CacheOptions RadianceShare(CacheOptions options) {
  options.memory_bytes = MemoryShares(options.memory_bytes).radiance;
  return options;
}

}  // namespace

namespace {

// Of a vector that is finite and not zero.
Vec3d UnitDirection(const Vec3d& d) {
  // Scaled first: the square of a long vector would overflow, that of a short one vanish.
  const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
  return Normalized(Vec3d{d.x / largest, d.y / largest, d.z / largest});
}

// UnitRay of all; the error of the first bad one.
absl::Status MakeUnitRays(const std::vector<Ray>& rays, WorkerPool& pool, std::vector<Ray>& unit,
                          double* cpu_ms) {
  constexpr size_t kChunk = 4096;
  unit.resize(rays.size());
  std::atomic<bool> all_good{true};
  const auto make_chunk = [&](size_t chunk) {
    const size_t end = std::min(rays.size(), (chunk + 1) * kChunk);
    for (size_t i = chunk * kChunk; i < end; ++i) {
      const auto& [origin, direction] = rays[i];
      if (!IsFinite(origin) || !IsFinite(direction) || direction == Vec3d{}) all_good = false;
      unit[i] = {origin, UnitDirection(direction)};
    }
  };
  pool.ParallelFor((rays.size() + kChunk - 1) / kChunk, make_chunk, cpu_ms);
  if (all_good) return absl::OkStatus();
  for (size_t i = 0; i < rays.size(); ++i) {
    if (const auto ray = UnitRay(rays[i], i); !ray.ok()) return ray.status();
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Ray> UnitRay(const Ray& ray, size_t index) {
  if (!IsFinite(ray.origin)) {
    return absl::InvalidArgumentError(
        absl::StrCat("rays[", index, "].origin: expected finite coordinates"));
  }
  if (!IsFinite(ray.direction) || ray.direction == Vec3d{}) {
    return absl::InvalidArgumentError(
        absl::StrCat("rays[", index, "].direction: expected a finite vector other than zero"));
  }
  return Ray{ray.origin, UnitDirection(ray.direction)};
}

SceneHost::SceneHost(std::shared_ptr<const Scene> scene, const CacheOptions& cache_options,
                     const RenderLimits& limits)
    : scene_(std::move(scene)),
      limits_(limits),
      tracer_(*scene_),
      cache_(tracer_, RadianceShare(cache_options)),
      surfaces_(tracer_, MemoryShares(cache_options.memory_bytes).surfaces),
      paths_(tracer_, MemoryShares(cache_options.memory_bytes).paths, cache_options.max_cell_depth),
      plan_(scene_->objects.size(), cache_options.always_ask),
      policy_(cache_options.policy) {
  surfaces_.SetPolicy(policy_);
  paths_.SetPolicy(policy_);
  pause_.Reset(cache_options.memory_bytes);
}

void SceneHost::Keep(std::shared_ptr<CellJournal> journal) {
  journal_ = std::move(journal);
  surfaces_.SetJournal(journal_.get());
  paths_.SetJournal(journal_.get());
}

Adopted SceneHost::Adopt(SceneHost& former, WorkerPool& pool) {
  const SceneChange change = ChangeBetween(former.scene(), scene());
  const ChangeReach reach(scene(), change);
  former.cache_.SetMemoryBytes(0);
  plan_.Inherit(former.plan_, change.now);
  SetPolicy(former.policy()).IgnoreError();  // it was good for the former one
  const ParallelLoop loop = [&pool](size_t count, const std::function<void(size_t)>& body) {
    pool.ParallelFor(count, body);
  };
  Adopted all = surfaces_.Adopt(former.surfaces_, reach, loop);
  const Adopted paths = paths_.Adopt(former.paths_, reach, loop);
  all.kept += paths.kept;
  all.dropped += paths.dropped;
  return all;
}

void SceneHost::SetMemoryBytes(uint64_t memory_bytes) {
  pause_.Reset(memory_bytes);
  const MemoryShares shares(memory_bytes);
  cache_.SetMemoryBytes(shares.radiance);
  surfaces_.SetMemoryBytes(shares.surfaces);
  paths_.SetMemoryBytes(shares.paths);
}

absl::Status SceneHost::SetPolicy(const std::string& name) {
  if (!name.empty()) {
    if (const auto made = MakePolicy(name, 0); !made.ok()) return made.status();
  }
  const std::lock_guard lock(policy_mutex_);
  if (name == policy_) return absl::OkStatus();
  policy_ = name;
  surfaces_.SetPolicy(name);
  paths_.SetPolicy(name);
  return absl::OkStatus();
}

std::string SceneHost::policy() const {
  const std::lock_guard lock(policy_mutex_);
  return policy_;
}

Evicted SceneHost::evicted() const {
  const Evicted surfaces = surfaces_.evicted(), paths = paths_.evicted();
  return {surfaces.cells + paths.cells, surfaces.bytes + paths.bytes};
}

RenderOptions SceneHost::OptionsFor(const RenderOptions& options) {
  RenderOptions own = options;
  const bool certified = options.mode == Mode::kCached && options.judge == JudgeKind::kCertified;
  // Who records wants to know what would be used.
  if (certified && !plan_.always() && recorder_ == nullptr && pause_.Take()) {
    own.mode = Mode::kClassical;
  }
  return own;
}

void SceneHost::EndFrame(const RenderOptions& options, const FrameStats& stats) {
  if (options.mode != Mode::kCached || options.judge != JudgeKind::kCertified) return;
  // Rays that need no search anyway look as if they were known: no cell serves many more than it
  // was divided for.
  const double served =
      kMinSurfaceUses * static_cast<double>(surfaces_.CellCount() + paths_.CellCount());
  const uint64_t known = stats.interpolated + stats.replayed + stats.residual;
  pause_.Note({.rays = stats.pixels,
               .known = std::min(known, static_cast<uint64_t>(served)),
               .tried = stats.cells_accepted + stats.cells_unkept,
               .unkept = stats.cells_unkept});
  FrameMark mark;
  if (recorder_ != nullptr && !options.ahead) {
    mark = {recorder_, recorder_->BeginFrame(), HashOfText(scene_->version)};
  }
  surfaces_.EndFrame(mark);
  paths_.EndFrame(mark);
}

const PacketTracer& SceneHost::packets() const {
  std::call_once(packets_made_, [this] {
    packets_ = std::make_unique<const PacketTracer>(tracer_);
    packet_bytes_ = packets_->ByteSize();
  });
  return *packets_;
}

std::vector<MemoryPart> SceneHost::Memory() const {
  return {{"paper's linetrees", cache_.ByteSize(), cache_.CellCount(), true},
          {"linetrees", paths_.ByteSize(), paths_.CellCount(), true},
          {"surface trees", surfaces_.ByteSize(), surfaces_.CellCount(), true},
          {"planner", plan_.ByteSize()},
          {"eviction", surfaces_.LedgerBytes() + paths_.LedgerBytes()},
          {"packets", packet_bytes_}};
}

SceneHost::Explanation SceneHost::Explain(double max_relative_error) const {
  const double sum_error = max_relative_error - packets().radiance_rounding();
  return {ExplainFeatures(packets().scene(), sum_error), ExplainPlan(plan_, surfaces_.TreeSizes()),
          plan_.decisions()};
}

bool SceneHost::GoesByPackets(const RenderOptions& options) const {
  const bool for_linetrees = options.mode == Mode::kCached && options.judge == JudgeKind::kPaper;
  return options.lanes == Lanes::kSimd && !for_linetrees && packets().IsWide();
}

absl::Status SceneHost::RenderRays(const FrameRequest& request, WorkerPool& pool,
                                   const CancelToken* cancel, const Progress& progress,
                                   Frame& frame) {
  const EyeRays eye_rays(request.camera, request.width, request.height);
  const int band = RowsPerBand(request.width);
  for (int top = 0; top < request.height; top += band) {
    const int rows = std::min(band, request.height - top);
    const auto width = static_cast<size_t>(request.width);
    std::vector<Ray> rays(static_cast<size_t>(rows) * width);
    pool.ParallelFor(
        static_cast<size_t>(rows),
        [&](size_t row) {
          for (size_t x = 0; x < width; ++x) {
            rays[row * width + x] =
                eye_rays.ThroughPixel(static_cast<int>(x), top + static_cast<int>(row));
          }
        },
        &frame.stats.cpu_ms);
    std::vector<RayAnswer> answers(rays.size());
    const auto band_progress = [&](double share) {
      if (progress) progress((top + share * rows) / request.height);
    };
    if (auto s = AnswerRays(tracer_, cache_, {surfaces_, paths_}, request.options, rays, pool,
                            cancel, band_progress, answers, frame.stats);
        !s.ok()) {
      return s;
    }
    StoreAnswers(answers, static_cast<size_t>(top) * width, frame);
  }
  return absl::OkStatus();
}

absl::Status SceneHost::RenderPackets(const FrameRequest& request, WorkerPool& pool,
                                      const CancelToken* cancel, const Progress& progress,
                                      Frame& frame) {
  frame.lane_rounding = packets().radiance_rounding();
  if (!request.sampling.IsPlain()) frame.lane_rounding += kMeanRounding;
  auto status = RenderBlocks(packets(), surfaces_, plan_, request.options,
                             EyeRays(request.camera, request.width, request.height), pool, cancel,
                             progress, frame);
  frame.stats.cache_bytes = CacheBytes();
  return status;
}

absl::StatusOr<Frame> SceneHost::RenderFrame(const FrameRequest& asked, WorkerPool& pool,
                                             const CancelToken* cancel, const Progress& progress) {
  if (auto s = ValidateCamera(asked.camera); !s.ok()) return s;
  if (auto s = ValidateSize(asked.width, asked.height, limits_); !s.ok()) return s;
  if (auto s = ValidateOptions(asked.options); !s.ok()) return s;
  if (auto s = ValidateSamples(asked.sampling, asked.width, asked.height, limits_); !s.ok()) {
    return s;
  }
  const Stopwatch stopwatch;
  FrameRequest request = asked;
  request.options = OptionsFor(asked.options);
  Frame frame = EmptyFrame(*scene_, request);
  absl::Status status;
  if (GoesByPackets(request.options)) {
    status = RenderPackets(request, pool, cancel, progress, frame);
  } else if (request.sampling.IsPlain()) {
    status = RenderRays(request, pool, cancel, progress, frame);
  } else {
    status = AnswerSamples(tracer_, cache_, {surfaces_, paths_}, request.options, pool, cancel,
                           progress, frame);
  }
  if (!status.ok()) return status;
  EndFrame(request.options, frame.stats);
  frame.stats.wall_ms = stopwatch.Ms();
  std::lock_guard lock(totals_mutex_);
  if (request.options.ahead) {
    ++ahead_frames_;
    return frame;
  }
  ++totals_.frames;
  totals_.stats += frame.stats;
  return frame;
}

absl::StatusOr<RayBatch> SceneHost::TraceRays(const std::vector<Ray>& rays,
                                              const RenderOptions& asked, WorkerPool& pool,
                                              const CancelToken* cancel) {
  if (auto s = ValidateOptions(asked); !s.ok()) return s;
  if (rays.size() > limits_.max_rays) {
    return absl::ResourceExhaustedError(
        absl::StrCat("rays: at most ", limits_.max_rays, " are allowed, got ", rays.size()));
  }
  const Stopwatch stopwatch;
  const RenderOptions options = OptionsFor(asked);
  RayBatch batch;
  std::vector<Ray> unit_rays;
  if (auto s = MakeUnitRays(rays, pool, unit_rays, &batch.stats.cpu_ms); !s.ok()) return s;
  batch.answers.resize(rays.size());
  absl::Status status;
  if (GoesByPackets(options)) {
    batch.lane_rounding = packets().radiance_rounding();
    status = AnswerRayBlocks(packets(), surfaces_, plan_, options, unit_rays, pool, cancel,
                             batch.answers, batch.stats);
    batch.stats.cache_bytes = CacheBytes();
  } else {
    status = AnswerRays(tracer_, cache_, {surfaces_, paths_}, options, unit_rays, pool, cancel,
                        nullptr, batch.answers, batch.stats);
  }
  if (!status.ok()) return status;
  EndFrame(options, batch.stats);
  batch.stats.wall_ms = stopwatch.Ms();
  std::lock_guard lock(totals_mutex_);
  ++totals_.ray_batches;
  totals_.stats += batch.stats;
  return batch;
}

AheadTotals SceneHost::ahead() const {
  AheadTotals totals;
  for (const AheadCounts& cells : {surfaces_.ahead(), paths_.ahead()}) {
    totals.cells.built += cells.built;
    totals.cells.used += cells.used;
  }
  std::lock_guard lock(totals_mutex_);
  totals.frames = ahead_frames_;
  return totals;
}

HostTotals SceneHost::totals() const {
  std::lock_guard lock(totals_mutex_);
  return totals_;
}

}  // namespace linetree
