// Flights of one or several clients, and the traces of what they use: the corpus that eviction
// policies are held against.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/policy/trace.h"
#include "core/render/scene_host.h"

namespace linetree {

enum class FlightPattern {
  kWalk,          // once along a tour
  kOrbit,         // a tour again and again
  kBackAndForth,  // half a tour to and fro
  kFourClients,   // four on the same tour, a tenth of it apart
  kTwoCrowds,     // sixteen, eight about either end of half a tour that all of them fly
  kTeleport,      // a view somewhere else at every frame
  kScan,  // one to and fro within a small part, another one along the whole tour now and then
};
inline constexpr std::array<std::string_view, 7> kFlightPatternNames = {
    "walk", "orbit", "back-and-forth", "four-clients", "two-crowds", "teleport", "scan"};

// `frames` views, those of several clients in turn. A tour leads through views that the seed
// scatters in the scene, as TeleportViews does, straight from one to the next and back to the
// first.
std::vector<Camera> FlightViews(const Scene& scene, const Camera& camera, FlightPattern pattern,
                                int frames, uint64_t seed = 1);

struct FlightTraceOptions {
  int width = 192, height = 192;
  RenderOptions options;
  uint64_t memory_bytes = uint64_t{2} << 30;  // nothing is to be evicted
};

// What the views use, one after the other, of a cache that starts empty. `progress` gets shares in
// [0, 1].
absl::StatusOr<Trace> RecordFlight(std::shared_ptr<const Scene> scene,
                                   const std::vector<Camera>& views,
                                   const FlightTraceOptions& options, WorkerPool& pool,
                                   const std::function<void(double)>& progress);

}  // namespace linetree
