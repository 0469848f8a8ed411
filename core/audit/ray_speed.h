// How fast batches of rays are: ray by ray, by packets in the order they come in and binned, and
// with the surface trees; in turn, in one process, so that what else the machine does meets all
// alike. Answers of all of them are held against the scalar classical tracer's.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

#include "absl/status/statusor.h"
#include "core/audit/speed_study.h"
#include "core/render/scene_host.h"

namespace linetree {

struct RaySpeedOptions {
  int width = 512, height = 512;  // a batch has width x height rays
  int repeats = 5;                // of which the median counts
  double epsilon = 0.02;
  uint64_t seed = 1;
  PathLimits limits;
};

// Who answers a batch. Caches are warm: one batch more than is measured goes first.
enum class RayWay { kScalar, kPackets, kPacketsBinned, kCached, kCachedBinned };
inline constexpr std::array<std::string_view, 5> kRayWayNames = {
    "scalar", "packets", "packets, binned", "cached", "cached, binned"};

// Batches of one kind, by RayWay.
struct RaySpeed {
  std::array<SpeedSpread, kRayWayNames.size()> ns;  // per ray
  // Which of the two orders RayOrder::kAuto takes.
  bool binned = false;
  // Shares of the rays of the last cached batch, binned.
  double interpolated = 0, replayed = 0;
  // Of all answers by packets, against scalar classical ones: |answer - classical| /
  // max(classical, RadianceFloor), and those beyond the promise.
  uint64_t rays = 0, beyond = 0;
  double largest_classical_error = 0, largest_cached_error = 0;
  double lane_rounding = 0;
};

struct RaySpeeds {
  RaySpeed coherent;    // the eye rays of a picture, row by row
  RaySpeed incoherent;  // from anywhere in the scene's bounds in any direction, new ones every time
};

absl::StatusOr<RaySpeeds> StudyRaySpeed(std::shared_ptr<const Scene> scene, const Camera& camera,
                                        const RaySpeedOptions& options, WorkerPool& pool);

}  // namespace linetree
