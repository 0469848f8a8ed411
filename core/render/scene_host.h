// One loaded scene with everything that answers for it: the tracer, the cache and the totals. What
// the server serves and what `linetree ... --local` uses are this same class.
//
// Thread safety: every method may be called from any thread at any time.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "absl/status/statusor.h"
#include "core/cache/radiance_cache.h"
#include "core/render/frame.h"
#include "core/render/options.h"
#include "core/render/worker_pool.h"
#include "core/scene/scene.h"
#include "core/trace/tracer.h"

namespace linetree {

// Lets a caller take back a request: rendering stops within one tile's work.
class CancelToken {
 public:
  void Cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  bool IsCancelled() const { return cancelled_.load(std::memory_order_relaxed); }

 private:
  std::atomic<bool> cancelled_{false};
};

// Called from the rendering thread with the share of the frame that is done, in [0, 1].
using Progress = std::function<void(double)>;

struct FrameRequest {
  Camera camera;
  int width = 512;
  int height = 512;
  RenderOptions options;
};

struct RayAnswer {
  Rgb radiance;
  Source source = Source::kBackground;
  Verdict verdict = Verdict::kUntried;
  int object = kNoObject;
  double depth = 0;  // distance along the ray; infinity for the background
};

struct RayBatch {
  std::vector<RayAnswer> answers;
  FrameStats stats;
};

struct HostTotals {
  uint64_t frames = 0;
  uint64_t ray_batches = 0;
  FrameStats stats;
};

class SceneHost {
 public:
  SceneHost(std::shared_ptr<const Scene> scene, const CacheOptions& cache_options);

  const Scene& scene() const { return *scene_; }
  const Tracer& tracer() const { return tracer_; }
  RadianceCache& cache() { return cache_; }

  // INVALID_ARGUMENT or RESOURCE_EXHAUSTED for a bad request, CANCELLED when `cancel` said so.
  absl::StatusOr<Frame> RenderFrame(const FrameRequest& request, WorkerPool& pool,
                                    const CancelToken* cancel = nullptr,
                                    const Progress& progress = nullptr);

  // Directions need not be unit length, but finite and non-zero.
  absl::StatusOr<RayBatch> TraceRays(const std::vector<Ray>& rays, const RenderOptions& options,
                                     WorkerPool& pool, const CancelToken* cancel = nullptr);

  HostTotals totals() const;
};

}  // namespace linetree
