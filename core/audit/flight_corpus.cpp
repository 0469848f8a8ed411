#include "core/audit/flight_corpus.h"

#include <cmath>

#include "core/audit/random_stream.h"
#include "core/audit/speed_paths.h"

namespace linetree {
namespace {

constexpr int kTourViews = 8;
constexpr int kLaps = 4;
constexpr int kClients = 4;
constexpr int kCrowd = 8;

Vec3d Between(const Vec3d& a, const Vec3d& b, double share) { return a + (b - a) * share; }

// A closed way through views; places on it are in [0, 1), others are taken modulo 1.
class Tour {
 public:
  explicit Tour(std::vector<Camera> views) : views_(std::move(views)) {}

  Camera At(double place) const {
    const double at = (place - std::floor(place)) * static_cast<double>(views_.size());
    const auto index = std::min(static_cast<size_t>(at), views_.size() - 1);
    const Camera& from = views_[index];
    const Camera& to = views_[(index + 1) % views_.size()];
    const double share = at - static_cast<double>(index);
    Camera camera = from;
    camera.eye = Between(from.eye, to.eye, share);
    camera.look_at = Between(from.look_at, to.look_at, share);
    return ValidateCamera(camera).ok() ? camera : from;
  }

 private:
  std::vector<Camera> views_;
};

// To and fro between 0 and 1, `time` 2 for both.
double Bounced(double time) {
  const double t = time - 2 * std::floor(time / 2);
  return t < 1 ? t : 2 - t;
}

// Where frame `i` of `count` is on the tour; `offsets` are those of the crowd's members.
double PlaceOf(FlightPattern pattern, int i, int count, const std::vector<double>& offsets) {
  const double time = static_cast<double>(i) / count;
  switch (pattern) {
    case FlightPattern::kOrbit:
      return kLaps * time;
    case FlightPattern::kBackAndForth:
      return 0.5 * Bounced(kLaps * time);
    case FlightPattern::kFourClients:
      return 2 * time + 0.1 * (i % kClients);
    case FlightPattern::kTwoCrowds: {
      const auto client = static_cast<size_t>(i) % offsets.size();
      const double begin = client < kCrowd ? 0 : 1;
      return 0.5 * Bounced(begin + 2 * time) + offsets[client];
    }
    case FlightPattern::kScan:
      return i % 4 == 3 ? time : 0.1 * Bounced(3 * kLaps * time);
    case FlightPattern::kWalk:
    case FlightPattern::kTeleport:
      break;
  }
  return time;
}

}  // namespace

std::vector<Camera> FlightViews(const Scene& scene, const Camera& camera, FlightPattern pattern,
                                int frames, uint64_t seed) {
  if (pattern == FlightPattern::kTeleport) return TeleportViews(scene, camera, frames, seed);
  const Tour tour(TeleportViews(scene, camera, kTourViews, seed));
  RandomStream random(seed);
  std::vector<double> offsets;
  for (int client = 0; client < 2 * kCrowd; ++client) offsets.push_back(random.Uniform(0, 0.05));
  std::vector<Camera> views;
  for (int i = 0; i < frames; ++i) views.push_back(tour.At(PlaceOf(pattern, i, frames, offsets)));
  return views;
}

absl::StatusOr<Trace> RecordFlight(std::shared_ptr<const Scene> scene,
                                   const std::vector<Camera>& views,
                                   const FlightTraceOptions& options, WorkerPool& pool,
                                   const std::function<void(double)>& progress) {
  TraceRecorder recorder;
  SceneHost host(std::move(scene), {.memory_bytes = options.memory_bytes, .policy = ""});
  host.RecordTo(&recorder);
  for (size_t i = 0; i < views.size(); ++i) {
    FrameRequest request;
    request.camera = views[i];
    request.width = options.width;
    request.height = options.height;
    request.options = options.options;
    if (auto frame = host.RenderFrame(request, pool); !frame.ok()) return frame.status();
    progress(static_cast<double>(i + 1) / static_cast<double>(views.size()));
  }
  return recorder.Take();
}

}  // namespace linetree
