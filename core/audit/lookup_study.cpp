#include "core/audit/lookup_study.h"

#include <atomic>
#include <chrono>
#include <latch>
#include <thread>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "core/scene/camera.h"

namespace linetree {
namespace {

// Rays of one reader, as many as one of a frame has.
constexpr size_t kChunk = 1024;

struct Lookup {
  Hit hit;
  Vec3d direction;
};

std::vector<Lookup> LookupsOf(const Tracer& tracer, const FrameRequest& request) {
  const EyeRays rays(request.camera, request.width, request.height);
  std::vector<Lookup> lookups;
  for (int y = 0; y < request.height; ++y) {
    for (int x = 0; x < request.width; ++x) {
      const Ray ray = rays.ThroughPixel(x, y);
      const Hit hit = tracer.Intersect(ray.origin, ray.direction, RayStart{});
      if (hit.IsHit()) lookups.push_back({hit, ray.direction});
    }
  }
  return lookups;
}

class LookupRun {
 public:
  LookupRun(SceneHost& host, std::vector<Lookup> lookups, double epsilon)
      : host_(host), lookups_(std::move(lookups)), epsilon_(epsilon) {}

  // One pass over all, begun at another place for every thread. Returns how many are known.
  size_t Pass(size_t first) const {
    size_t known = 0;
    for (size_t begin = 0; begin < lookups_.size(); begin += kChunk) {
      const SurfaceCache::Reader lights(host_.surfaces(), epsilon_);
      const PathCache::Reader paths(host_.paths(), {}, nullptr);
      const size_t end = std::min(lookups_.size(), begin + kChunk);
      for (size_t i = begin; i < end; ++i) {
        const Lookup& lookup = lookups_[(i + first) % lookups_.size()];
        known += lights.Find(lookup.hit).lists != nullptr ? 1 : 0;
        paths.Find(lookup.hit, lookup.direction);
      }
    }
    return known;
  }

  // Per second, by so many threads.
  double Measure(int threads, int passes) const {
    std::latch begun(threads + 1);
    std::vector<std::thread> all;
    for (int t = 0; t < threads; ++t) {
      all.emplace_back([&, t] {
        const size_t first =
            lookups_.size() / static_cast<size_t>(threads) * static_cast<size_t>(t);
        begun.arrive_and_wait();
        for (int pass = 0; pass < passes; ++pass) Pass(first);
      });
    }
    begun.arrive_and_wait();
    const auto begin = std::chrono::steady_clock::now();
    for (std::thread& thread : all) thread.join();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    return static_cast<double>(lookups_.size()) * threads * passes / took.count();
  }

  size_t rays() const { return lookups_.size(); }

 private:
  SceneHost& host_;
  const std::vector<Lookup> lookups_;
  const double epsilon_;
};

}  // namespace

absl::StatusOr<LookupStudy> StudyLookups(std::shared_ptr<const Scene> scene,
                                         const LookupStudyOptions& options, WorkerPool& pool,
                                         const std::function<void(double)>& progress) {
  const Camera* camera = scene->FindCamera("");
  if (camera == nullptr) return absl::InvalidArgumentError("expected a scene with a camera");
  SceneHost host(scene);
  FrameRequest request{
      .camera = *camera, .width = options.width, .height = options.height, .options = {}};
  request.options.max_relative_error = options.epsilon;
  for (int i = 0; i < options.warm_frames; ++i) {
    if (const auto frame = host.RenderFrame(request, pool); !frame.ok()) return frame.status();
    progress(0.3 * (i + 1) / options.warm_frames);
  }
  const LookupRun run(host, LookupsOf(host.tracer(), request), options.epsilon);
  if (run.rays() == 0) return absl::InvalidArgumentError("expected a view of some object");
  LookupStudy study;
  study.rays = run.rays();
  study.known = run.Pass(0);
  study.cells = host.surfaces().CellCount() + host.paths().CellCount();
  for (const int threads : options.threads) {
    for (const EpochKind kind : {EpochKind::kRcu, EpochKind::kSharedLock}) {
      study.rows.push_back({threads, kind, {}});
    }
  }
  const absl::Cleanup as_before = [] { SetEpochKind(EpochKind::kRcu); };
  std::vector<std::vector<double>> measured(study.rows.size());
  for (int repeat = 0; repeat < options.repeat; ++repeat) {
    for (size_t i = 0; i < study.rows.size(); ++i) {
      SetEpochKind(study.rows[i].kind);
      measured[i].push_back(run.Measure(study.rows[i].threads, options.passes));
    }
    progress(0.3 + 0.7 * (repeat + 1) / options.repeat);
  }
  for (size_t i = 0; i < study.rows.size(); ++i) study.rows[i].per_second = SpreadOf(measured[i]);
  return study;
}

}  // namespace linetree
