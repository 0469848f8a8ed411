// The frame path's work, compiled for every target of Highway (frame_tracer.h).
#pragma once

#include "core/cache/surface_cache.h"
#include "core/frame/booked_packets.h"
#include "core/frame/frame_plan.h"
#include "core/packet/packet_kernels.h"

namespace linetree {

// Whose trees are asked.
enum class Asking {
  kBooked,     // everybody's, and the work is booked in the plan
  kExploring,  // of objects where they are worth growing
  kPlanned,    // where they pay as they are
};

// As RenderBlockWide, with the trees' help. `booked`: which packets are booked, and where they are
// kept; null: none.
void RenderFrameBlockWide(const PacketScene& scene, const BlockTask& task,
                          const SurfaceCache::Reader& lights, FramePlan& plan, Asking asking,
                          BookedPackets* booked, PacketWorkspace& workspace, PacketCounts& counts);
// Books them once more, with the trees as they are now.
void BookAgainWide(const PacketScene& scene, const BookedPackets& booked,
                   const SurfaceCache::Reader& lights, FramePlan& plan, PacketWorkspace& workspace);

// A region of at most kBlockSide pixels a side, each with several samples.
struct OnceTask {
  const EyeRays& eye_rays;  // of the pixels' centres
  PacketTracer::Region region;
  size_t stride;
  const PixelTarget& target;  // of pixels
  const PixelSamples& samples;
  int shown_column, shown_row;  // the cell of a pixel whose sample gives the depth
};
// What became of it, by tile.
struct OnceBlock {
  LaneMask done[kBlockPixels / kPacketLanes];  // pixels that are in the target
  SeenFace seen[kBlockPixels / kPacketLanes];  // by all samples
};
// Evaluates pixels once where that is certain to be within the reader's epsilon of the mean of all
// samples; see pixel_sheet-inl.h.
void RenderOnceWide(const PacketScene& scene, const OnceTask& task,
                    const SurfaceCache::Reader& lights, const FramePlan& plan,
                    PacketWorkspace& workspace, PacketCounts& counts, OnceBlock& block);

// Of the packets of a block of rays, those whose bit is set in `packets`.
void TraceCachedRaysWide(const PacketScene& scene, const RayTask& task, uint64_t packets,
                         const SurfaceCache::Reader& lights, FramePlan& plan, Asking asking,
                         PacketWorkspace& workspace, PacketCounts& counts);

}  // namespace linetree
