#include "core/audit/thread_speed.h"

#include <vector>

namespace linetree {

absl::StatusOr<ThreadSpeed> StudyThreads(std::shared_ptr<const Scene> scene,
                                         const FrameSpeedOptions& options, int frames) {
  WorkerPool one(1), two(2);
  FrameRequest request{scene->cameras[0], options.width, options.height, {}};
  request.options.lanes = Lanes::kSimd;
  request.options.limits = options.limits;
  request.options.max_relative_error = options.epsilon;
  request.sampling = options.sampling;
  std::vector<double> ratios, classical_ratios;
  FrameSpeed difference;
  for (int repeat = 0; repeat < options.repeats; ++repeat) {
    SceneHost host_of_one(scene), host_of_two(scene);
    // Frames of both in turn; the last ones' ratio.
    const auto race = [&](Mode mode, int count) -> absl::StatusOr<double> {
      request.options.mode = mode;
      double ratio = 0;
      for (int i = 0; i < count; ++i) {
        const auto by_one = host_of_one.RenderFrame(request, one);
        if (!by_one.ok()) return by_one.status();
        const auto by_two = host_of_two.RenderFrame(request, two);
        if (!by_two.ok()) return by_two.status();
        ratio = by_one->stats.wall_ms / by_two->stats.wall_ms;
        AddErrors(*by_two, *by_one, RadianceFloor(*scene), 0, difference);
      }
      return ratio;
    };
    const auto cached = race(Mode::kCached, frames);
    if (!cached.ok()) return cached.status();
    const auto classical = race(Mode::kClassical, 1);
    if (!classical.ok()) return classical.status();
    ratios.push_back(*cached);
    classical_ratios.push_back(*classical);
  }
  return ThreadSpeed{SpreadOf(std::move(ratios)).median,
                     SpreadOf(std::move(classical_ratios)).median, difference.beyond};
}

}  // namespace linetree
