#include "core/audit/speed_paths.h"

#include <optional>
#include <span>

#include "core/audit/frame_study.h"
#include "core/audit/random_stream.h"

namespace linetree {
namespace {

using Turns = std::span<const FrameSpeed::Turn>;

bool IsStill(SpeedPath path) { return path == SpeedPath::kCold || path == SpeedPath::kWarm; }

PathSpeed SpeedOf(SpeedPath path, Turns turns) {
  std::vector<double> classical, cached;
  for (const FrameSpeed::Turn& turn : turns) {
    classical.push_back(turn.classical.median);
    cached.push_back(turn.cached.median);
  }
  PathSpeed speed;
  static_cast<FlightRatios&>(speed) = RatiosOf(turns);
  speed.path = path;
  speed.frames = turns.size();
  speed.classical = SpreadOf(std::move(classical));
  speed.cached = SpreadOf(std::move(cached));
  return speed;
}

// Of one frame it is that frame's own spread that tells.
PathSpeed SpeedOfOne(SpeedPath path, const FrameSpeed::Turn& turn) {
  PathSpeed speed = SpeedOf(path, {&turn, 1});
  speed.classical = turn.classical;
  speed.cached = turn.cached;
  return speed;
}

PathSpeed SpeedOf(SpeedPath path, const FrameSpeed& flight) {
  const Turns turns = flight.turns;
  PathSpeed speed;
  if (path == SpeedPath::kCold) {
    speed = SpeedOfOne(path, turns.front());
  } else if (path == SpeedPath::kWarm) {
    speed = SpeedOfOne(path, turns.back());
    if (turns.size() > 1) speed.least_ratio = RatiosOf(turns.subspan(1)).least_ratio;
  } else {
    speed = SpeedOf(path, turns);
  }
  speed.flight = flight;
  return speed;
}

std::vector<Camera> ViewsOf(SpeedPath path, const Scene& scene, const SpeedFlights& flights) {
  const Camera& camera = scene.cameras[0];
  if (path == SpeedPath::kTeleport) return TeleportViews(scene, camera, flights.flight_frames);
  if (path != SpeedPath::kWalk) {
    return std::vector<Camera>(static_cast<size_t>(flights.still_frames), camera);
  }
  return flights.walk.empty() ? WalkViews(camera, flights.flight_frames) : flights.walk;
}

}  // namespace

std::vector<Camera> WalkViews(const Camera& camera, int frames) {
  return OrbitOf(camera, frames, -(frames / 2));
}

std::vector<Camera> TeleportViews(const Scene& scene, const Camera& camera, int frames,
                                  uint64_t seed) {
  constexpr int kSide = 64;
  constexpr int kTries = 64;
  constexpr double kFarthest = 0.9;  // of the way
  const Tracer tracer(scene);
  const EyeRays rays(camera, kSide, kSide);
  RandomStream random(seed);
  const auto seen = [&]() -> std::optional<Vec3d> {
    for (int i = 0; i < kTries; ++i) {
      const int x = random.Below(kSide), y = random.Below(kSide);
      const Ray ray = rays.ThroughPixel(x, y);
      const Hit hit = tracer.Intersect(ray.origin, ray.direction, RayStart{});
      if (hit.IsHit()) return hit.point;
    }
    return std::nullopt;
  };
  std::vector<Camera> views;
  while (views.size() < static_cast<size_t>(frames)) {
    Camera view = camera;
    const auto towards = seen(), at = seen();
    if (towards && at) {
      view.eye = camera.eye + (*towards - camera.eye) * (kFarthest * random.Unit());
      view.look_at = *at;
    }
    views.push_back(ValidateCamera(view).ok() ? view : camera);
  }
  return views;
}

absl::StatusOr<std::vector<PathSpeed>> StudyPaths(const SpeedSetting& setting,
                                                  const SpeedFlights& flights,
                                                  const std::function<void(double)>& progress) {
  WorkerPool pool(setting.threads);
  std::optional<FrameSpeed> still;
  std::vector<PathSpeed> speeds;
  for (const SpeedPath path : flights.paths) {
    if (IsStill(path) && still) {
      speeds.push_back(SpeedOf(path, *still));
      continue;
    }
    const auto share = [&](double done) {
      if (!progress) return;
      progress((static_cast<double>(speeds.size()) + done) /
               static_cast<double>(flights.paths.size()));
    };
    auto flight = StudyFrameSpeed(setting.scene, ViewsOf(path, *setting.scene, flights),
                                  setting.options, pool, share);
    if (!flight.ok()) return flight.status();
    speeds.push_back(SpeedOf(path, *flight));
    if (IsStill(path)) still = *std::move(flight);
  }
  return speeds;
}

}  // namespace linetree
