// Batches of rays by packets, classical or with what the surface trees know.
//
// Rays that keep together as they come go sixteen to a packet in that order. Of others all hits are
// found first, in packets of rays that are neighbours in space and direction; then the hits are
// binned by object, face and place, and their light is found in packets of those, so that shadow
// rays of a packet keep together and its lanes lie in few cells. What rays spawn is collected block
// by block. Hits and light states of a lane do not depend on the other lanes, so neither do
// answers.
//
// Cached batches go in waves, as frames do (frame_blocks.h): one packet of every 64, then four
// more, then the rest; between them the trees grow where the hits are, if the planner finds that it
// pays.
#pragma once

#include <span>

#include "absl/status/status.h"
#include "core/cache/surface_cache.h"
#include "core/frame/frame_plan.h"
#include "core/packet/packet_tracer.h"
#include "core/render/answer_rays.h"
#include "core/render/frame.h"
#include "core/render/options.h"
#include "core/render/worker_pool.h"

namespace linetree {

// Batches smaller than this are answered with what the trees know and teach them nothing: to look
// for what may be learnt would cost more than it brings.
inline constexpr size_t kLeastTeachingRays = 1024;

// Answers rays[i] in answers[i]; directions are of unit length, `packets` IsWide(). Radiance is off
// by packets.radiance_rounding() more than the options say. Under Mode::kCached the trees of
// `surfaces` are asked and grow; sums of diffuse light are used where they leave room for that
// rounding. Adds to stats. CANCELLED when `cancel` said so (what was built stays).
absl::Status AnswerRayBlocks(const PacketTracer& packets, SurfaceCache& surfaces, FramePlan& plan,
                             const RenderOptions& options, std::span<const Ray> rays,
                             WorkerPool& pool, const CancelToken* cancel,
                             std::span<RayAnswer> answers, FrameStats& stats);

}  // namespace linetree
