#include "core/audit/stage_speed.h"

#include <vector>

namespace linetree {
namespace {

using Times = std::vector<double>;

double Median(const Times& times) { return SpreadOf(times).median; }

class StageRace {
 public:
  StageRace(std::shared_ptr<const Scene> scene, const FrameSpeedOptions& options, WorkerPool& pool)
      : scene_(std::move(scene)), options_(options), pool_(pool), plain_(scene_), dark_(Dark()) {}

  absl::Status Run(int warm_frames) {
    SceneHost flat(scene_), full(scene_);  // with caches: without branches and with
    flat.packets();
    full.packets();
    for (int i = 0; i < warm_frames; ++i) {
      const bool last = i + 1 == warm_frames;
      // In turn, also those that do not count: all meet the same machine.
      if (auto s = Take(dark_, Mode::kClassical, 1, last ? &eye_ : nullptr); !s.ok()) return s;
      if (auto s = Take(plain_, Mode::kClassical, 1, last ? &flat_ : nullptr); !s.ok()) return s;
      if (auto s = Take(plain_, Mode::kClassical, 0, last ? &full_ : nullptr); !s.ok()) return s;
      if (auto s = Take(flat, Mode::kCached, 1, last ? &warm_flat_ : nullptr); !s.ok()) return s;
      Times* all = last ? &warm_.all : i == 0 ? &cold_.all : nullptr;
      if (auto s = Take(full, Mode::kCached, 0, all, last ? &warm_ : &cold_); !s.ok()) return s;
    }
    return absl::OkStatus();
  }

  StageSpeed Finish() const {
    StageSpeed speed;
    speed.eye = Median(eye_);
    speed.classical = LegsOf(Median(flat_), Median(full_));
    speed.warm = LegsOf(Median(warm_flat_), Median(warm_.all));
    speed.warm_learning = {Median(warm_.probe), Median(warm_.learn), Median(warm_.all)};
    // Of a single frame the warm one is the cold one.
    speed.cold_learning = speed.warm_learning;
    if (!cold_.all.empty()) {
      speed.cold_learning = {Median(cold_.probe), Median(cold_.learn), Median(cold_.all)};
    }
    return speed;
  }

 private:
  struct Learning {
    Times probe, learn, all;
  };

  std::shared_ptr<const Scene> Dark() const {
    auto dark = std::make_shared<Scene>(*scene_);
    dark->lights.clear();
    return dark;
  }

  // depth 0: that of the options.
  absl::Status Take(SceneHost& host, Mode mode, int depth, Times* all,
                    Learning* learning = nullptr) {
    FrameRequest request{scene_->cameras[0], options_.width, options_.height, {}};
    request.options.mode = mode;
    request.options.lanes = Lanes::kSimd;
    request.options.max_relative_error = options_.epsilon;
    request.options.limits = options_.limits;
    request.sampling = options_.sampling;
    if (depth > 0) request.options.limits.max_depth = depth;
    const auto frame = host.RenderFrame(request, pool_);
    if (!frame.ok()) return frame.status();
    if (all == nullptr) return absl::OkStatus();
    const double ns = 1e6 / static_cast<double>(frame->object.size());
    all->push_back(ns * frame->stats.wall_ms);
    if (learning != nullptr) {
      learning->probe.push_back(ns * frame->stages.probe_ms);
      learning->learn.push_back(ns * frame->stages.learn_ms);
    }
    return absl::OkStatus();
  }

  StageSpeed::Legs LegsOf(double flat, double full) const {
    return {flat - Median(eye_), full - flat, full};
  }

  const std::shared_ptr<const Scene> scene_;
  const FrameSpeedOptions& options_;
  WorkerPool& pool_;
  SceneHost plain_, dark_;
  Times eye_, flat_, full_, warm_flat_;
  Learning cold_, warm_;
};

}  // namespace

absl::StatusOr<StageSpeed> StudyStages(std::shared_ptr<const Scene> scene,
                                       const FrameSpeedOptions& options, int warm_frames,
                                       WorkerPool& pool) {
  StageRace race(std::move(scene), options, pool);
  for (int repeat = 0; repeat < options.repeats; ++repeat) {
    if (auto s = race.Run(warm_frames); !s.ok()) return s;
  }
  return race.Finish();
}

}  // namespace linetree
