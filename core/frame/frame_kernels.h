// The frame path's work, compiled for every target of Highway (frame_tracer.h).
#pragma once

#include "core/cache/surface_cache.h"
#include "core/frame/frame_plan.h"
#include "core/packet/packet_kernels.h"

namespace linetree {

// Whose trees are asked.
enum class Asking {
  kBooked,     // everybody's, and the work is booked in the plan
  kExploring,  // of objects where they are worth growing
  kPlanned,    // where they pay as they are
};

// As RenderBlockWide, with the trees' help.
void RenderFrameBlockWide(const PacketScene& scene, const BlockTask& task,
                          const SurfaceCache::Reader& lights, FramePlan& plan, Asking asking,
                          PacketWorkspace& workspace, PacketCounts& counts);

// Of the packets of a block of rays, those whose bit is set in `packets`.
void TraceCachedRaysWide(const PacketScene& scene, const RayTask& task, uint64_t packets,
                         const SurfaceCache::Reader& lights, FramePlan& plan, Asking asking,
                         PacketWorkspace& workspace, PacketCounts& counts);

}  // namespace linetree
