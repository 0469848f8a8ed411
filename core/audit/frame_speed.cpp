#include "core/audit/frame_speed.h"

#include <algorithm>
#include <cmath>

namespace linetree {
namespace {

// What was measured of one frame of all repeats.
struct Samples {
  std::vector<double> classical, cached, ratio;
};

class FrameRace {
 public:
  FrameRace(std::shared_ptr<const Scene> scene, const Camera& camera,
            const FrameSpeedOptions& options, WorkerPool& pool)
      : scene_(std::move(scene)), options_(options), pool_(pool), plain_(scene_) {
    request_.camera = camera;
    request_.width = options.width;
    request_.height = options.height;
    request_.options.limits = options.limits;
    request_.options.lanes = Lanes::kSimd;
    request_.options.max_relative_error = options.epsilon;
  }

  absl::Status Run(std::vector<Samples>& samples, FrameSpeed& speed) {
    SceneHost host(scene_);
    for (Samples& sample : samples) {
      const auto classical = Render(plain_, Mode::kClassical);
      if (!classical.ok()) return classical.status();
      const auto cached = Render(host, Mode::kCached);
      if (!cached.ok()) return cached.status();
      sample.classical.push_back(NsPerPixel(*classical));
      sample.cached.push_back(NsPerPixel(*cached));
      sample.ratio.push_back(sample.classical.back() / sample.cached.back());
      Compare(*cached, *classical, speed);
      const auto share = [&](uint64_t part) {
        return static_cast<double>(part) / static_cast<double>(cached->stats.pixels);
      };
      speed.interpolated = share(cached->stats.interpolated);
      speed.replayed = share(cached->stats.replayed);
      speed.residual = share(cached->stats.residual);
    }
    speed.cells = host.surfaces().CellCount();
    speed.bytes = host.surfaces().ByteSize();
    return absl::OkStatus();
  }

  // Not measured: pages and caches of the processor.
  absl::Status WarmUp() { return Render(plain_, Mode::kClassical).status(); }

 private:
  absl::StatusOr<Frame> Render(SceneHost& host, Mode mode) {
    FrameRequest request = request_;
    request.options.mode = mode;
    return host.RenderFrame(request, pool_);
  }
  static double NsPerPixel(const Frame& frame) {
    return 1e6 * frame.stats.wall_ms / static_cast<double>(frame.stats.pixels);
  }
  void Compare(const Frame& cached, const Frame& classical, FrameSpeed& speed) const {
    const double floor = RadianceFloor(*scene_);
    speed.pixels += cached.object.size();
    for (size_t p = 0; p < cached.object.size(); ++p) {
      double worst = 0;
      for (size_t i = 3 * p; i < 3 * p + 3; ++i) {
        const double truth = classical.radiance[i];
        const double off = std::abs(static_cast<double>(cached.radiance[i]) - truth);
        worst = std::max(worst, off / std::max(truth, floor));
      }
      speed.largest_error = std::max(speed.largest_error, worst);
      speed.beyond += worst > options_.epsilon ? 1 : 0;
    }
  }

  const std::shared_ptr<const Scene> scene_;
  const FrameSpeedOptions& options_;
  WorkerPool& pool_;
  SceneHost plain_;
  FrameRequest request_;
};

}  // namespace

absl::StatusOr<FrameSpeed> StudyFrameSpeed(std::shared_ptr<const Scene> scene, const Camera& camera,
                                           const FrameSpeedOptions& options, WorkerPool& pool) {
  FrameSpeed speed;
  FrameRace race(std::move(scene), camera, options, pool);
  if (auto s = race.WarmUp(); !s.ok()) return s;
  std::vector<Samples> samples(static_cast<size_t>(options.frames));
  for (int repeat = 0; repeat < options.repeats; ++repeat) {
    if (auto s = race.Run(samples, speed); !s.ok()) return s;
  }
  for (Samples& sample : samples) {
    speed.turns.push_back({SpreadOf(std::move(sample.classical)),
                           SpreadOf(std::move(sample.cached)),
                           SpreadOf(std::move(sample.ratio)).median});
  }
  return speed;
}

}  // namespace linetree
