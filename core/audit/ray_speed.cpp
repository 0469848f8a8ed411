#include "core/audit/ray_speed.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/audit/random_stream.h"
#include "core/render/ray_order.h"

namespace linetree {
namespace {

constexpr size_t kWays = kRayWayNames.size();

bool IsCached(RayWay way) { return way == RayWay::kCached || way == RayWay::kCachedBinned; }

std::vector<Ray> EyeRaysOf(const Camera& camera, const RaySpeedOptions& options) {
  const EyeRays eye_rays(camera, options.width, options.height);
  std::vector<Ray> rays;
  for (int y = 0; y < options.height; ++y) {
    for (int x = 0; x < options.width; ++x) rays.push_back(eye_rays.ThroughPixel(x, y));
  }
  return rays;
}

std::vector<Ray> RandomRays(const Box3& bounds, size_t count, uint64_t seed) {
  RandomStream random(seed);
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    ray.origin = random.InBox(bounds.min, bounds.max);
    ray.direction = random.Direction();
  }
  return rays;
}

// Each way of answering has a host of its own.
class RayRace {
 public:
  RayRace(std::shared_ptr<const Scene> scene, const RaySpeedOptions& options, WorkerPool& pool)
      : scene_(std::move(scene)), options_(options), pool_(pool) {
    for (auto& host : hosts_) host = std::make_unique<SceneHost>(scene_);
  }

  // Answers the batch in every way.
  absl::Status Run(const std::vector<Ray>& rays, bool counts) {
    std::array<RayBatch, kWays> batches;
    for (size_t way = 0; way < kWays; ++way) {
      auto batch = hosts_[way]->TraceRays(rays, OptionsOf(static_cast<RayWay>(way)), pool_);
      if (!batch.ok()) return batch.status();
      batches[way] = *std::move(batch);
      const double ns = 1e6 * batches[way].stats.wall_ms / static_cast<double>(rays.size());
      if (counts) ns_[way].push_back(ns);
    }
    for (size_t way = 1; way < kWays; ++way) {
      Compare(static_cast<RayWay>(way), batches[way], batches[0]);
    }
    const FrameStats& last = batches[kWays - 1].stats;
    const auto pixels = static_cast<double>(last.pixels);
    speed_.interpolated = static_cast<double>(last.interpolated) / pixels;
    speed_.replayed = static_cast<double>(last.replayed) / pixels;
    speed_.binned = !KeepTogether(rays, scene_->WorldBounds());
    return absl::OkStatus();
  }

  RaySpeed speed() {
    for (size_t way = 0; way < kWays; ++way) speed_.ns[way] = SpreadOf(ns_[way]);
    return speed_;
  }

 private:
  RenderOptions OptionsOf(RayWay way) const {
    RenderOptions options;
    options.mode = IsCached(way) ? Mode::kCached : Mode::kClassical;
    options.max_relative_error = options_.epsilon;
    options.limits = options_.limits;
    options.lanes = way == RayWay::kScalar ? Lanes::kScalar : Lanes::kSimd;
    const bool binned = way == RayWay::kPacketsBinned || way == RayWay::kCachedBinned;
    options.ray_order = binned ? RayOrder::kBinned : RayOrder::kAsGiven;
    return options;
  }

  void Compare(RayWay way, const RayBatch& batch, const RayBatch& classical) {
    const double floor = RadianceFloor(*scene_);
    const double allowed = (IsCached(way) ? options_.epsilon : 0) + batch.lane_rounding;
    double& largest = IsCached(way) ? speed_.largest_cached_error : speed_.largest_classical_error;
    speed_.lane_rounding = batch.lane_rounding;
    speed_.rays += batch.answers.size();
    for (size_t i = 0; i < batch.answers.size(); ++i) {
      const Rgb &answer = batch.answers[i].radiance, &truth = classical.answers[i].radiance;
      double worst = 0;
      for (int c = 0; c < 3; ++c) {
        worst = std::max(worst, std::abs(answer[c] - truth[c]) / std::max(truth[c], floor));
      }
      largest = std::max(largest, worst);
      speed_.beyond += worst > allowed ? 1 : 0;
    }
  }

  const std::shared_ptr<const Scene> scene_;
  const RaySpeedOptions& options_;
  WorkerPool& pool_;
  std::array<std::unique_ptr<SceneHost>, kWays> hosts_;
  std::array<std::vector<double>, kWays> ns_;
  RaySpeed speed_;
};

// rays_of(turn) is the batch of that turn; the first ones warm the caches.
template <class Fn>
absl::StatusOr<RaySpeed> Race(std::shared_ptr<const Scene> scene, const RaySpeedOptions& options,
                              WorkerPool& pool, Fn&& rays_of) {
  RayRace race(std::move(scene), options, pool);
  constexpr int kWarmUps = 4;
  for (int turn = 0; turn < kWarmUps + options.repeats; ++turn) {
    if (auto s = race.Run(rays_of(turn), turn >= kWarmUps); !s.ok()) return s;
  }
  return race.speed();
}

}  // namespace

absl::StatusOr<RaySpeeds> StudyRaySpeed(std::shared_ptr<const Scene> scene, const Camera& camera,
                                        const RaySpeedOptions& options, WorkerPool& pool) {
  const std::vector<Ray> eye_rays = EyeRaysOf(camera, options);
  const Box3 bounds = scene->WorldBounds();
  RaySpeeds speeds;
  auto coherent = Race(scene, options, pool, [&](int) { return eye_rays; });
  if (!coherent.ok()) return coherent.status();
  speeds.coherent = *coherent;
  auto incoherent = Race(scene, options, pool, [&](int turn) {
    return RandomRays(bounds, eye_rays.size(), MixBits(options.seed) + static_cast<uint64_t>(turn));
  });
  if (!incoherent.ok()) return incoherent.status();
  speeds.incoherent = *incoherent;
  return speeds;
}

}  // namespace linetree
