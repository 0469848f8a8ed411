// Whole frames by packets: blocks of 32 x 32 pixels, classical or with what the surface trees know.
//
// Cached frames go in waves: some blocks first, of which a few packets are booked in the plan,
// then, where what these promise has been seen to be kept, a square of every other block, then the
// rest; between them the trees grow where rays have gone, and what was booked is booked again,
// without being traced again. Waves see the trees only between builds, so a picture does not depend
// on the number of threads.
#pragma once

#include "absl/status/status.h"
#include "core/cache/surface_cache.h"
#include "core/frame/frame_plan.h"
#include "core/packet/packet_tracer.h"
#include "core/render/answer_rays.h"
#include "core/render/frame.h"
#include "core/render/options.h"
#include "core/render/worker_pool.h"

namespace linetree {

// Fills in the frame's pixels, each the mean of its samples, and adds to its stats. Under
// Mode::kCached the trees of `surfaces` are asked and grow; sums of diffuse light are used where
// they leave room for the packets' own rounding. CANCELLED when `cancel` said so (what was built
// stays).
absl::Status RenderBlocks(const PacketTracer& packets, SurfaceCache& surfaces, FramePlan& plan,
                          const RenderOptions& options, const EyeRays& eye_rays, WorkerPool& pool,
                          const CancelToken* cancel, const Progress& progress, Frame& frame);

}  // namespace linetree
