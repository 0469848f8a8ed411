#include "core/audit/frame_speed.h"

#include <algorithm>
#include <cmath>

namespace linetree {
namespace {

// What was measured of one view in all repeats.
struct Samples {
  std::vector<double> classical, cached, ratio;
};

class FrameRace {
 public:
  FrameRace(std::shared_ptr<const Scene> scene, const std::vector<Camera>& views,
            const FrameSpeedOptions& options, WorkerPool& pool)
      : scene_(std::move(scene)),
        views_(views),
        options_(options),
        pool_(pool),
        plain_(scene_),
        samples_(views.size()) {}

  absl::Status Run(const std::function<void(double)>& progress) {
    SceneHost host(scene_, options_.cache);
    if (options_.lanes == Lanes::kSimd) host.packets();
    for (size_t i = 0; i < views_.size(); ++i) {
      if (auto s = RunTurn(host, views_[i], samples_[i]); !s.ok()) return s;
      if (progress) progress((static_cast<double>(i) + 1) / static_cast<double>(views_.size()));
    }
    speed_.memory = host.Memory();
    if (options_.lanes == Lanes::kSimd) speed_.explanation = host.Explain(options_.epsilon);
    speed_.cells_built = host.totals().stats.cells_accepted;
    speed_.evicted = host.evicted();
    return absl::OkStatus();
  }

  // Not measured: pages and caches of the processor.
  absl::Status WarmUp() { return Render(plain_, views_.front(), Mode::kClassical).status(); }

  FrameSpeed Finish() {
    for (Samples& sample : samples_) {
      speed_.turns.push_back({SpreadOf(std::move(sample.classical)),
                              SpreadOf(std::move(sample.cached)),
                              SpreadOf(std::move(sample.ratio)).median});
    }
    return std::move(speed_);
  }

 private:
  absl::Status RunTurn(SceneHost& host, const Camera& view, Samples& sample) {
    const auto classical = Render(plain_, view, Mode::kClassical);
    if (!classical.ok()) return classical.status();
    const auto cached = Render(host, view, Mode::kCached);
    if (!cached.ok()) return cached.status();
    sample.classical.push_back(NsPerPixel(*classical));
    sample.cached.push_back(NsPerPixel(*cached));
    sample.ratio.push_back(sample.classical.back() / sample.cached.back());
    AddErrors(*cached, *classical, RadianceFloor(*scene_), options_.epsilon, speed_);
    const auto share = [&](uint64_t part) {
      return static_cast<double>(part) / static_cast<double>(cached->stats.pixels);
    };
    speed_.interpolated = share(cached->stats.interpolated);
    speed_.replayed = share(cached->stats.replayed);
    speed_.residual = share(cached->stats.residual);
    return absl::OkStatus();
  }

  absl::StatusOr<Frame> Render(SceneHost& host, const Camera& view, Mode mode) {
    FrameRequest request;
    request.camera = view;
    request.width = options_.width;
    request.height = options_.height;
    request.options.limits = options_.limits;
    request.sampling = options_.sampling;
    request.options.lanes = options_.lanes;
    request.options.max_relative_error = options_.epsilon;
    request.options.mode = mode;
    return host.RenderFrame(request, pool_);
  }
  static double NsPerPixel(const Frame& frame) {
    return 1e6 * frame.stats.wall_ms / static_cast<double>(frame.object.size());
  }

  const std::shared_ptr<const Scene> scene_;
  const std::vector<Camera>& views_;
  const FrameSpeedOptions& options_;
  WorkerPool& pool_;
  SceneHost plain_;
  std::vector<Samples> samples_;  // by view
  FrameSpeed speed_;
};

}  // namespace

FlightRatios RatiosOf(std::span<const FrameSpeed::Turn> turns) {
  std::vector<double> ratios;
  double classical = 0, cached = 0;
  for (const FrameSpeed::Turn& turn : turns) {
    ratios.push_back(turn.ratio);
    classical += turn.classical.median;
    cached += turn.cached.median;
  }
  const SpeedSpread spread = SpreadOf(std::move(ratios));
  return {spread.median, spread.least, classical / cached};
}

void AddErrors(const Frame& cached, const Frame& classical, double floor, double epsilon,
               FrameSpeed& speed) {
  std::vector<double> errors(cached.object.size());
  for (size_t p = 0; p < errors.size(); ++p) {
    bool within = true;
    for (size_t i = 3 * p; i < 3 * p + 3; ++i) {
      const double truth = classical.radiance[i];
      const double off = std::abs(static_cast<double>(cached.radiance[i]) - truth);
      const double error = off / std::max(truth, floor);
      within = within && error <= epsilon;  // what is not a number is not
      errors[p] = std::max(errors[p], error);
    }
    speed.beyond += within ? 0 : 1;
  }
  speed.pixels += errors.size();
  // The rank of CompareRadiance's p999.
  const auto rank = static_cast<size_t>(std::ceil(0.999 * static_cast<double>(errors.size())));
  const auto p999 = errors.begin() + static_cast<std::ptrdiff_t>(rank - 1);
  std::nth_element(errors.begin(), p999, errors.end());
  speed.p999_error = std::max(speed.p999_error, *p999);
  speed.largest_error = std::max(speed.largest_error, *std::max_element(p999, errors.end()));
}

absl::StatusOr<FrameSpeed> StudyFrameSpeed(std::shared_ptr<const Scene> scene,
                                           const std::vector<Camera>& views,
                                           const FrameSpeedOptions& options, WorkerPool& pool,
                                           const std::function<void(double)>& progress) {
  FrameRace race(std::move(scene), views, options, pool);
  if (auto s = race.WarmUp(); !s.ok()) return s;
  for (int repeat = 0; repeat < options.repeats; ++repeat) {
    const auto share = [&](double done) {
      if (progress) progress((repeat + done) / options.repeats);
    };
    if (auto s = race.Run(share); !s.ok()) return s;
  }
  return race.Finish();
}

}  // namespace linetree
