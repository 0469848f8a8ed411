#include "core/audit/edit_study.h"

#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "core/audit/frame_study.h"
#include "core/audit/random_stream.h"

namespace linetree {
namespace {

std::vector<size_t> SpheresOf(const Scene& scene) {
  std::vector<size_t> spheres;
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    if (std::holds_alternative<SphereShape>(scene.objects[i].shape)) spheres.push_back(i);
  }
  return spheres;
}

std::shared_ptr<const Scene> Moved(const Scene& former, const std::vector<size_t>& spheres,
                                   RandomStream& random) {
  auto scene = std::make_shared<Scene>(former);
  Object& object = scene->objects[spheres[random.Index(spheres.size())]];
  const double radius = Length(object.bounds.Extent()) / std::sqrt(12.0);
  Vec3d& center = std::get<SphereShape>(object.shape).frame.center;
  center = center + random.Direction() * radius;
  object.bounds = Bounds(object.shape);
  return scene;
}

class EditRun {
 public:
  EditRun(std::shared_ptr<const Scene> scene, const EditStudyOptions& options, WorkerPool& pool)
      : options_(options), pool_(pool), host_(std::make_unique<SceneHost>(std::move(scene))) {}

  uint64_t Cells() const { return host_->surfaces().CellCount() + host_->paths().CellCount(); }

  absl::StatusOr<Frame> Render(const Camera& camera, Mode mode) {
    FrameRequest request;
    request.camera = camera;
    request.width = options_.width;
    request.height = options_.height;
    request.options.mode = mode;
    request.options.max_relative_error = options_.epsilon;
    request.options.limits = options_.limits;
    return host_->RenderFrame(request, pool_);
  }

  // The next scene's host; returns how long it took to take over what is left, in ms.
  double Become(std::shared_ptr<const Scene> scene, double& dropped_share) {
    auto next = std::make_unique<SceneHost>(std::move(scene));
    const auto begin = std::chrono::steady_clock::now();
    const Adopted adopted = next->Adopt(*host_, pool_);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    const auto all = static_cast<double>(adopted.kept + adopted.dropped);
    dropped_share = all > 0 ? static_cast<double>(adopted.dropped) / all : 0;
    host_ = std::move(next);
    return took.count();
  }

  // A cached frame against a classical one.
  absl::Status Check(const Camera& camera, EditStudy& study) {
    const auto cached = Render(camera, Mode::kCached);
    if (!cached.ok()) return cached.status();
    const auto classical = Render(camera, Mode::kClassical);
    if (!classical.ok()) return classical.status();
    const double floor = RadianceFloor(host_->scene());
    for (size_t i = 0; i < cached->radiance.size(); i += 3) {
      bool beyond = false;
      for (size_t c = i; c < i + 3; ++c) {
        const double exact = classical->radiance[c];
        const double allowed = (options_.epsilon + kFloatAllowance) * std::max(exact, floor);
        beyond = beyond || !(std::abs(cached->radiance[c] - exact) <= allowed);
      }
      ++study.pixels;
      study.beyond += beyond ? 1 : 0;
    }
    return absl::OkStatus();
  }

 private:
  // Both were rounded to float, by half a unit of 24 bits each.
  static constexpr double kFloatAllowance = 0x1p-22;

  const EditStudyOptions& options_;
  WorkerPool& pool_;
  std::unique_ptr<SceneHost> host_;
};

}  // namespace

absl::StatusOr<EditStudy> StudyEdits(std::shared_ptr<const Scene> scene,
                                     const EditStudyOptions& options, WorkerPool& pool,
                                     const std::function<void(double)>& progress) {
  const std::vector<size_t> spheres = SpheresOf(*scene);
  if (spheres.empty()) return absl::InvalidArgumentError("scene: expected a sphere to move");
  if (scene->cameras.empty()) return absl::InvalidArgumentError("scene: expected a camera");
  const int frames = options.warm_frames + options.edits * options.frames_between;
  const std::vector<Camera> orbit = OrbitOf(scene->cameras[0], frames);
  RandomStream random(options.seed);
  EditRun run(scene, options, pool);
  EditStudy study;
  study.objects = scene->objects.size();
  std::vector<double> find_ms, dropped;
  for (int frame = 0; frame < frames; ++frame) {
    const int edited = frame - options.warm_frames;
    if (edited == 0) study.cells = run.Cells();
    if (edited >= 0 && edited % options.frames_between == 0) {
      scene = Moved(*scene, spheres, random);
      find_ms.push_back(run.Become(scene, dropped.emplace_back()));
      if (auto s = run.Check(orbit[static_cast<size_t>(frame)], study); !s.ok()) return s;
    } else {
      const auto warm = run.Render(orbit[static_cast<size_t>(frame)], Mode::kCached);
      if (!warm.ok()) return warm.status();
    }
    if (progress) progress(static_cast<double>(frame + 1) / frames);
  }
  study.find_ms = SpreadOf(std::move(find_ms));
  study.dropped_share = SpreadOf(std::move(dropped));
  return study;
}

}  // namespace linetree
