// The frame path's work, compiled for every target of Highway (frame_tracer.h).
#pragma once

#include "core/cache/surface_cache.h"
#include "core/frame/frame_plan.h"
#include "core/packet/packet_kernels.h"

namespace linetree {

// As RenderBlockWide, with the trees' help. `booking`: the work is booked in the plan.
void RenderFrameBlockWide(const PacketScene& scene, const BlockTask& task,
                          const SurfaceCache::Reader& lights, FramePlan& plan, bool booking,
                          PacketWorkspace& workspace, PacketCounts& counts);

// Of the packets of a block of rays, those whose bit is set in `packets`.
void TraceCachedRaysWide(const PacketScene& scene, const RayTask& task, uint64_t packets,
                         const SurfaceCache::Reader& lights, FramePlan& plan, bool booking,
                         PacketWorkspace& workspace, PacketCounts& counts);

}  // namespace linetree
