#include "core/audit/frame_study.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

namespace linetree {
namespace {

FrameRequest RequestFor(const Camera& camera, const FrameStudyOptions& options, Mode mode,
                        double epsilon) {
  FrameRequest request;
  request.camera = camera;
  request.width = request.height = options.side;
  request.options.mode = mode;
  request.options.judge = JudgeKind::kCertified;
  request.options.max_relative_error = epsilon;
  request.options.lanes = options.lanes;
  return request;
}

// Both frames hold floats: each may be off by half a unit in the last place of what it stores.
double AllowedOf(double classical, double floor, double epsilon) {
  const double base = std::max(classical, floor);
  return epsilon > 0 ? base * (epsilon + (1 + epsilon) * 0x1p-23) : 0;
}

void Compare(const Frame& cached, const Frame& classical, double floor, FrameStudyRow& row) {
  const size_t pixels = cached.object.size();
  row.pixels += pixels;
  for (size_t p = 0; p < pixels; ++p) {
    const float* a = &cached.radiance[3 * p];
    const float* b = &classical.radiance[3 * p];
    if (std::memcmp(a, b, 3 * sizeof(float)) == 0) continue;
    ++row.unequal;
    bool beyond = false;
    for (int c = 0; c < 3; ++c) {
      const double error = std::abs(static_cast<double>(a[c]) - b[c]);
      const double allowed = AllowedOf(b[c], floor, row.epsilon);
      beyond = beyond || !(error <= allowed);
      if (allowed > 0) row.largest_error = std::max(row.largest_error, error / allowed);
    }
    row.violations += beyond ? 1 : 0;
  }
}

}  // namespace

std::vector<Camera> OrbitOf(const Camera& camera, int frames, int first_deg) {
  std::vector<Camera> path;
  const Vec3d axis = Normalized(camera.up);
  const Vec3d arm = camera.eye - camera.look_at;
  for (int deg = first_deg; deg < first_deg + frames; ++deg) {
    const double angle_rad = deg * std::numbers::pi / 180;
    const double cosine = std::cos(angle_rad);
    const Vec3d turned = arm * cosine + Cross(axis, arm) * std::sin(angle_rad) +
                         axis * (Dot(axis, arm) * (1 - cosine));
    path.push_back(camera);
    if (deg != 0) path.back().eye = camera.look_at + turned;
  }
  return path;
}

absl::StatusOr<std::vector<FrameStudyRow>> StudyFrames(
    std::shared_ptr<const Scene> scene, const std::vector<Camera>& path,
    const FrameStudyOptions& options, WorkerPool& pool,
    const std::function<void(double)>& progress) {
  std::vector<Frame> classical;
  SceneHost plain(scene);
  double searches = 0;
  for (const Camera& camera : path) {
    auto frame = plain.RenderFrame(RequestFor(camera, options, Mode::kClassical, 0), pool);
    if (!frame.ok()) return frame.status();
    searches += static_cast<double>(frame->stats.base.intersect);
    classical.push_back(*std::move(frame));
  }
  std::vector<FrameStudyRow> rows;
  for (const double epsilon : options.epsilons) {
    SceneHost host(scene);
    FrameStudyRow row;
    row.epsilon = epsilon;
    double asked = 0;
    for (size_t i = 0; i <= path.size(); ++i) {
      const bool again = i == path.size();  // the first view once more
      const size_t view = again ? 0 : i;
      auto frame = host.RenderFrame(RequestFor(path[view], options, Mode::kCached, epsilon), pool);
      if (!frame.ok()) return frame.status();
      Compare(*frame, classical[view], RadianceFloor(*scene), row);
      row.interpolated += frame->stats.interpolated;
      row.replayed += frame->stats.replayed;
      row.residual += frame->stats.residual;
      const auto own = static_cast<double>(frame->stats.base.intersect);
      if (again) {
        row.warm_searches = own / static_cast<double>(classical[0].stats.base.intersect);
      } else {
        asked += own;
      }
    }
    row.path_searches = asked / searches;
    rows.push_back(row);
    progress(static_cast<double>(rows.size()) / static_cast<double>(options.epsilons.size()));
  }
  return rows;
}

}  // namespace linetree
