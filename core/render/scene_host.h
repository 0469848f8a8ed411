// One loaded scene with everything that answers for it: the tracer, the cache and the totals. What
// the server serves and what `linetree ... --local` uses are this same class.
//
// Thread safety: every method may be called from any thread at any time.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "absl/status/statusor.h"
#include "core/cache/path_cache.h"
#include "core/cache/radiance_cache.h"
#include "core/cache/surface_cache.h"
#include "core/frame/frame_plan.h"
#include "core/frame/plan_explanation.h"
#include "core/packet/packet_tracer.h"
#include "core/render/answer_rays.h"
#include "core/render/cache_pause.h"
#include "core/render/frame.h"
#include "core/render/options.h"
#include "core/render/scene_memory.h"
#include "core/render/worker_pool.h"
#include "core/scene/scene.h"
#include "core/trace/tracer.h"

namespace linetree {

struct FrameRequest {
  Camera camera;
  int width = 512;
  int height = 512;
  RenderOptions options;
  Sampling sampling{};
};

struct RayBatch {
  std::vector<RayAnswer> answers;
  // What arithmetic in float may add to max_relative_error; 0 for answers in double.
  double lane_rounding = 0;
  FrameStats stats;
};

// Sums since the scene was loaded.
struct HostTotals {
  uint64_t frames = 0;
  uint64_t ray_batches = 0;
  FrameStats stats;
};

// What was rendered ahead (RenderOptions::ahead), which HostTotals leave out.
struct AheadTotals {
  uint64_t frames = 0;
  AheadCounts cells;
};

// The ray that TraceRays answers for `ray`: the same with a direction of unit length, or
// INVALID_ARGUMENT for the field of rays[index] that is not finite or zero. The length of a unit
// vector is off by rounding, so a second call may change a bit again.
absl::StatusOr<Ray> UnitRay(const Ray& ray, size_t index);

class SceneHost {
 public:
  explicit SceneHost(std::shared_ptr<const Scene> scene, const CacheOptions& cache_options = {},
                     const RenderLimits& limits = {});

  const Scene& scene() const { return *scene_; }
  const Tracer& tracer() const { return tracer_; }
  // Made when it is first asked for.
  const PacketTracer& packets() const;
  RadianceCache& cache() { return cache_; }
  SurfaceCache& surfaces() { return surfaces_; }
  PathCache& paths() { return paths_; }

  // Takes over what the host of a former scene has learnt and the change from that scene to this
  // one has not touched: of surface trees, certified linetrees and the planner. The former one goes
  // on answering, without cache. Before this one answers anybody; the pool looks at several objects
  // at once. n log n for n objects, and a look at every cell of an object that reflects or
  // transmits.
  Adopted Adopt(SceneHost& former, WorkerPool& pool);

  // Who is to hear of cells of surface trees and certified linetrees, and lives with this host.
  // Before it answers anybody.
  void Keep(std::shared_ptr<CellJournal> journal);

  // Bytes of both kinds of linetrees, samples and surface trees together, and the budget that they
  // share.
  uint64_t CacheBytes() const {
    return cache_.ByteSize() + surfaces_.ByteSize() + paths_.ByteSize();
  }
  void SetMemoryBytes(uint64_t memory_bytes);
  // Everything that is kept for the scene: the caches, which share the budget (their bytes are
  // CacheBytes), and what they and packets need beside it.
  std::vector<MemoryPart> Memory() const;

  // The policy by which surface trees and certified linetrees evict, of AllPolicies, or
  // INVALID_ARGUMENT. What is known of their use is forgotten.
  absl::Status SetPolicy(const std::string& name);
  std::string policy() const;
  // Of surface trees and certified linetrees, since the scene was loaded.
  Evicted evicted() const;
  // Records what frames and batches of rays use from now on. Before anybody asks; the recorder must
  // outlive the host.
  void RecordTo(TraceRecorder* recorder) { recorder_ = recorder; }

  // What frames by packets do about the scene at this epsilon, and the planner about its objects.
  struct Explanation {
    std::vector<FeatureNote> features;
    std::vector<ObjectPlan> objects;
    uint32_t decisions = 0;  // how often the planner has decided
  };
  Explanation Explain(double max_relative_error) const;

  // INVALID_ARGUMENT or RESOURCE_EXHAUSTED for a bad request, CANCELLED when `cancel` said so.
  absl::StatusOr<Frame> RenderFrame(const FrameRequest& request, WorkerPool& pool,
                                    const CancelToken* cancel = nullptr,
                                    const Progress& progress = nullptr);

  // Directions need not be unit length, but finite and non-zero. Depths are distances, in the
  // scene's units.
  absl::StatusOr<RayBatch> TraceRays(const std::vector<Ray>& rays, const RenderOptions& options,
                                     WorkerPool& pool, const CancelToken* cancel = nullptr);

  HostTotals totals() const;
  AheadTotals ahead() const;

 private:
  // What a request gets: no cache while that pauses.
  RenderOptions OptionsFor(const RenderOptions& options);
  // After a frame or a batch of rays.
  void EndFrame(const RenderOptions& options, const FrameStats& stats);
  // By packets, or ray by ray.
  bool GoesByPackets(const RenderOptions& options) const;
  absl::Status RenderRays(const FrameRequest& request, WorkerPool& pool, const CancelToken* cancel,
                          const Progress& progress, Frame& frame);
  absl::Status RenderPackets(const FrameRequest& request, WorkerPool& pool,
                             const CancelToken* cancel, const Progress& progress, Frame& frame);

  const std::shared_ptr<const Scene> scene_;
  const RenderLimits limits_;
  const Tracer tracer_;
  mutable std::once_flag packets_made_;
  mutable std::unique_ptr<const PacketTracer> packets_;
  mutable std::atomic<uint64_t> packet_bytes_{0};  // 0: not made yet
  std::shared_ptr<CellJournal> journal_;           // outlives the caches
  RadianceCache cache_;
  SurfaceCache surfaces_;
  PathCache paths_;
  FramePlan plan_;
  CachePause pause_;
  TraceRecorder* recorder_ = nullptr;
  mutable std::mutex policy_mutex_;
  std::string policy_;  // guarded by policy_mutex_
  mutable std::mutex totals_mutex_;
  HostTotals totals_;  // guarded by totals_mutex_, as is ahead_frames_
  uint64_t ahead_frames_ = 0;
};

}  // namespace linetree
