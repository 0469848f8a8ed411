// What a caller may ask of a frame or batch of rays: one plain struct, validated once.
#pragma once

#include "absl/status/status.h"
#include "core/scene/pixel_samples.h"
#include "core/trace/tracer.h"

namespace linetree {

enum class Mode { kCached, kClassical };
enum class JudgeKind {
  kPaper,      // linetrees and the paper's tests: epsilon is aimed at
  kCertified,  // surface trees and certified linetrees: epsilon is proved
};

// How rays are traced.
enum class Lanes {
  kScalar,  // one by one, in double, with linetrees where rays branch
  kSimd,    // sixteen rays at a time, radiance summed in float: off by PacketRadianceRounding more;
            // with surface trees where a planner finds that they pay (frame_plan.h)
};

// Which rays of a batch share packets (ray_blocks.h). No answer depends on it; it is not part of a
// request over the wire.
enum class RayOrder {
  kAuto,     // as they come if they keep together, binned if not
  kAsGiven,  // as they come
  kBinned,   // neighbours are searched for hits together, hits on one face shaded together
};

struct RenderOptions {
  Mode mode = Mode::kCached;
  JudgeKind judge = JudgeKind::kCertified;
  // The promise: |answer - classical| <= max_relative_error * max(classical, RadianceFloor(scene)).
  double max_relative_error = 0.1;
  PathLimits limits;
  Lanes lanes = Lanes::kScalar;
  RayOrder ray_order = RayOrder::kAuto;
  // Nobody waits for the answer: what the caches learn from it, they learn ahead of whoever will
  // (AheadCounts). Not part of a request over the wire.
  bool ahead = false;
};

// Largest picture and batch that are accepted.
struct RenderLimits {
  int max_side = 16384;
  uint64_t max_pixels = uint64_t{1} << 26;
  uint64_t max_samples = uint64_t{1} << 32;  // of all pixels together
  uint64_t max_rays = uint64_t{1} << 20;
};

// OK, or INVALID_ARGUMENT naming the field (as in service.proto) and what was expected.
absl::Status ValidateOptions(const RenderOptions& options);

// OK, INVALID_ARGUMENT for a size below 1, RESOURCE_EXHAUSTED for one beyond the limits.
absl::Status ValidateSize(int64_t width, int64_t height, const RenderLimits& limits);

// OK, INVALID_ARGUMENT as ValidateSampling, RESOURCE_EXHAUSTED for more samples than the limits
// have room for. The size is valid.
absl::Status ValidateSamples(const Sampling& sampling, int width, int height,
                             const RenderLimits& limits);

}  // namespace linetree
