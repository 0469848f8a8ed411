#include "core/audit/live_audit.h"

#include <sys/resource.h>

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/audit/comparison.h"
#include "core/audit/sampling.h"
#include "core/render/sample_mean.h"

namespace linetree {
namespace {

// Of the calling thread (0). Next to busy threads a nice one gets a hundredth of a processor: not
// none, so that it never keeps the allocator's locks for long. Where that fails it is like any
// other.
void TakeLowestPriority() {
  constexpr int kNicest = 19;
  setpriority(PRIO_PROCESS, 0, kNicest);
}

}  // namespace

AuditCounts::Values AuditCounts::values() const {
  // Violations first: they never come out as more than what was checked.
  Values values;
  values.violations = violations_.load(std::memory_order_acquire);
  values.checked = checked_.load(std::memory_order_relaxed);
  values.dropped = dropped_.load(std::memory_order_relaxed);
  values.max_error_over_allowed = max_error_over_allowed_.load(std::memory_order_relaxed);
  return values;
}

LiveAudit::LiveAudit(const LiveAuditOptions& options, OnViolation on_violation)
    : options_(options),
      on_violation_(std::move(on_violation)),
      waiting_(options.share > 0 ? options.max_waiting : 1) {
  if (options_.share > 0) thread_ = std::thread([this] { Run(); });
}

LiveAudit::~LiveAudit() {
  stopping_ = true;
  WakeUp();
  if (thread_.joinable()) thread_.join();
}

void LiveAudit::WakeUp() {
  wake_ups_.fetch_add(1, std::memory_order_release);
  wake_ups_.notify_one();
}

template <class SampleAt>
void LiveAudit::OfferSamples(Request request, size_t answers, const SampleAt& sample_at) {
  if (!(options_.share > 0) || request.options.mode != Mode::kCached) return;
  SampledIndices indices(options_.share, requests_.fetch_add(1, std::memory_order_relaxed));
  uint64_t index = indices.Next();
  if (index >= answers) return;
  AuditCounts& counts = *request.scene.counts;
  const auto shared = std::make_shared<const Request>(std::move(request));
  bool pushed = false;
  for (; index < answers; index = indices.Next()) {
    Sample sample = sample_at(index);
    sample.request = shared;
    sample.index = index;
    if (waiting_.TryPush(sample)) {
      queued_.fetch_add(1, std::memory_order_relaxed);
      pushed = true;
    } else {
      counts.dropped_.fetch_add(1, std::memory_order_relaxed);
    }
  }
  if (pushed) WakeUp();
}

void LiveAudit::Offer(const LiveScene& scene, const std::vector<Ray>& rays,
                      const RenderOptions& options, const RayBatch& batch) {
  OfferSamples({scene, options, /*from_frame=*/false, batch.lane_rounding}, batch.answers.size(),
               [&](size_t i) {
                 return Sample{nullptr, rays[i], batch.answers[i].radiance};
               });
}

void LiveAudit::Offer(const LiveScene& scene, const RenderOptions& options, const Frame& frame) {
  const EyeRays eye_rays(frame.camera, frame.width, frame.height);
  const auto width = static_cast<size_t>(frame.width);
  Request request = {scene, options, /*from_frame=*/true, frame.lane_rounding};
  if (!frame.sampling.IsPlain()) {
    request.sampled = {frame.camera, frame.width, frame.height, frame.sampling};
  }
  OfferSamples(std::move(request), frame.source.size(), [&](size_t i) {
    const Ray ray = eye_rays.ThroughPixel(static_cast<int>(i % width), static_cast<int>(i / width));
    const float* radiance = &frame.radiance[3 * i];
    return Sample{nullptr, ray, {radiance[0], radiance[1], radiance[2]}};
  });
}

void LiveAudit::Run() {
  TakeLowestPriority();
  while (!stopping_) {
    const uint32_t seen = wake_ups_.load(std::memory_order_acquire);
    while (!stopping_) {
      const std::optional<Sample> sample = waiting_.TryPop();
      if (!sample) break;
      Check(*sample);
    }
    if (!stopping_) wake_ups_.wait(seen, std::memory_order_acquire);
  }
}

Rgb LiveAudit::ClassicalOf(const Sample& sample) {
  const Request& request = *sample.request;
  const auto trace = [&](const Ray& ray) {
    RayCounts none;
    return request.scene.host->tracer().Radiance(ray.origin, ray.direction, request.options.limits,
                                                 none);
  };
  if (!request.sampled) return trace(request.from_frame ? sample.ray : *UnitRay(sample.ray, 0));
  const auto& [camera, width, height, sampling] = *request.sampled;
  const PixelSamples samples(sampling);
  const EyeRays eye_rays = EyeRays(camera, width, height).Divided(samples.across(), samples.down());
  const auto columns = static_cast<size_t>(width);
  const int left = static_cast<int>(sample.index % columns) * samples.across();
  const int top = static_cast<int>(sample.index / columns) * samples.down();
  return MeanOfSamples(samples, [&](int column, int row) {
    return trace(samples.RayOf(eye_rays, left + column, top + row));
  });
}

void LiveAudit::Check(const Sample& sample) {
  const Request& request = *sample.request;
  const Scene& scene = request.scene.host->scene();
  const Rgb classical = ClassicalOf(sample);
  const double epsilon = request.options.max_relative_error, floor = RadianceFloor(scene);
  const bool rounded = request.from_frame || request.lane_rounding > 0;
  const Comparison result =
      rounded ? CompareRounded(sample.answer, classical, epsilon, floor, request.lane_rounding)
              : Compare(sample.answer, classical, epsilon, floor);
  AuditCounts& counts = *request.scene.counts;
  if (result.error_over_allowed > counts.max_error_over_allowed_.load(std::memory_order_relaxed)) {
    counts.max_error_over_allowed_.store(result.error_over_allowed, std::memory_order_relaxed);
  }
  counts.checked_.fetch_add(1, std::memory_order_relaxed);
  if (result.IsViolation()) {
    counts.violations_.fetch_add(1, std::memory_order_release);
    on_violation_(
        {.scene = absl::StrCat(request.scene.name, " ", scene.version),
         .ray = sample.ray,
         .options = request.options,
         .from_frame = request.from_frame,
         .pixel = request.sampled
                      ? PixelText(request.sampled->camera, request.sampled->width,
                                  request.sampled->height, request.sampled->sampling, sample.index)
                      : "",
         .answer = sample.answer,
         .classical = classical,
         .error_over_allowed = result.error_over_allowed});
  }
  done_.fetch_add(1, std::memory_order_release);
  done_.notify_all();
}

void LiveAudit::WaitUntilChecked() {
  const uint64_t wanted = queued_.load(std::memory_order_relaxed);
  for (uint64_t done = done_.load(std::memory_order_acquire); done < wanted;
       done = done_.load(std::memory_order_acquire)) {
    done_.wait(done, std::memory_order_acquire);
  }
}

}  // namespace linetree
