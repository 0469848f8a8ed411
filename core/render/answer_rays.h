// Radiance along a set of rays, from the cache where it may answer and traced where not, ray by
// ray: the path behind frames, flights and ray batches that do not go by packets.
//
// For every ray the nearest hit is searched. Then, in rounds, rays look their cells up; cells that
// enough rays of the batch ask for and that have not been tried are built; rays whose cell was
// refused go one level deeper in the next round. What no cell answers is traced. Rounds see the
// cache only between builds, so with one client a picture does not depend on the number of threads.
//
// Under the certified judge a ray is interpolated where its cell of a linetree may answer, and
// evaluated where not: shadow rays then ask the surface trees, reflected and refracted rays the
// linetrees, before the scene is searched. A small share of the rays goes first, to see which cells
// the others will need.
#pragma once

#include <atomic>
#include <functional>
#include <span>
#include <vector>

#include "absl/status/status.h"
#include "core/cache/path_cache.h"
#include "core/cache/radiance_cache.h"
#include "core/cache/surface_cache.h"
#include "core/render/frame.h"
#include "core/render/options.h"
#include "core/render/worker_pool.h"
#include "core/scene/scene.h"
#include "core/trace/tracer.h"

namespace linetree {

struct RayAnswer {
  Rgb radiance;
  Source source = Source::kBackground;
  Verdict verdict = Verdict::kUntried;  // of the last cell on the way
  int object = kNoObject;
  double depth = Box3::kInf;  // distance along the ray; infinity for the background
};

// Lets a caller take back a request: rendering stops within a fraction of a second.
class CancelToken {
 public:
  void Cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  bool IsCancelled() const { return cancelled_.load(std::memory_order_relaxed); }

 private:
  std::atomic<bool> cancelled_{false};
};

// Called from the rendering thread with the share of the work that is done, in [0, 1].
using Progress = std::function<void(double)>;

// An interpolant holds floats; below this epsilon (2^-20) nothing could be promised, so every ray
// is traced.
inline constexpr double kMinInterpolationError = 0x1p-20;

// What the certified judge remembers.
struct CertifiedTrees {
  SurfaceCache& surfaces;
  PathCache& paths;

  uint64_t ByteSize() const { return surfaces.ByteSize() + paths.ByteSize(); }
};

// Adds the answers' sources and verdicts to stats.
void CountAnswers(std::span<const RayAnswer> answers, FrameStats& stats);

// Answers rays[i] in answers[i]; directions are of unit length. Adds to stats. CANCELLED when
// `cancel` said so (what was built stays).
absl::Status AnswerRays(const Tracer& tracer, RadianceCache& cache, CertifiedTrees trees,
                        const RenderOptions& options, std::span<const Ray> rays, WorkerPool& pool,
                        const CancelToken* cancel, const Progress& progress,
                        std::span<RayAnswer> answers, FrameStats& stats);

}  // namespace linetree
