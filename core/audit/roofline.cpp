#include "core/audit/roofline.h"

#include <vector>

namespace linetree {
namespace {

std::shared_ptr<const Scene> WithoutLights(const Scene& scene) {
  auto dark = std::make_shared<Scene>(scene);
  dark->lights.clear();
  return dark;
}

// Nanoseconds per pixel of a classical frame.
absl::StatusOr<double> Take(SceneHost& host, const FrameSpeedOptions& options, int max_depth,
                            WorkerPool& pool) {
  FrameRequest request{host.scene().cameras[0], options.width, options.height, {}};
  request.options.mode = Mode::kClassical;
  request.options.lanes = Lanes::kSimd;
  request.options.limits = options.limits;
  request.options.limits.max_depth = max_depth;
  request.sampling = options.sampling;
  const auto frame = host.RenderFrame(request, pool);
  if (!frame.ok()) return frame.status();
  return 1e6 * frame->stats.wall_ms / static_cast<double>(frame->object.size());
}

}  // namespace

absl::StatusOr<Roofline> StudyRoofline(std::shared_ptr<const Scene> scene,
                                       const FrameSpeedOptions& options, WorkerPool& pool) {
  SceneHost lit(scene), dark(WithoutLights(*scene));
  const int depth = options.limits.max_depth;
  std::vector<double> eye, unlit, all;
  // The first ones meet cold caches, and do not count.
  for (int i = 0; i <= options.repeats; ++i) {
    const auto by_eye = Take(dark, options, 1, pool);
    if (!by_eye.ok()) return by_eye.status();
    const auto by_path = Take(dark, options, depth, pool);
    if (!by_path.ok()) return by_path.status();
    const auto whole = Take(lit, options, depth, pool);
    if (!whole.ok()) return whole.status();
    if (i == 0) continue;
    eye.push_back(*by_eye);
    unlit.push_back(*by_path);
    all.push_back(*whole);
  }
  Roofline roofline;
  const double without_lights = SpreadOf(std::move(unlit)).median;
  roofline.eye = SpreadOf(std::move(eye)).median;
  roofline.branches = without_lights - roofline.eye;
  roofline.classical = SpreadOf(std::move(all)).median;
  roofline.lights = roofline.classical - without_lights;
  return roofline;
}

}  // namespace linetree
