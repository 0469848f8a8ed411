// The packet tracer's work, compiled for every target of Highway. What each does is said in
// packet_tracer.h; the scene is usable().
#pragma once

#include <span>

#include "core/packet/packet_tracer.h"

namespace linetree {

// Whether this machine has vectors that the kernels are written for; if not, the others do nothing.
bool HaveWideKernels();
void EyePacketWide(const EyeRays& eye_rays, int column, int row, PacketRays& rays);
void FindHitsWide(const PacketScene& scene, const PacketRays& rays, PacketHits& hits,
                  PacketCounts& counts);
void CastShadowsWide(const PacketScene& scene, const PacketHits& hits, LaneMask lanes, int light,
                     PacketWorkspace& workspace, PacketShadow& shadow, PacketCounts& counts);
void ShadeWide(const PacketScene& scene, const PacketRays& rays, const PacketHits& hits,
               std::span<const PacketShadow> shadows, PacketRgb& radiance);
void RadianceWide(const PacketScene& scene, const PacketRays& rays, const PathLimits& limits,
                  PacketWorkspace& workspace, PacketRgb& radiance, PacketCounts& counts);

// A region of at most kBlockSide pixels a side.
struct BlockTask {
  const EyeRays& eye_rays;
  PacketTracer::Region region;
  const PathLimits& limits;
  size_t stride;
  const PixelTarget& target;
  // Whether squares of pixels are looked at as a whole first.
  bool sees_squares;
  // Of the region's tiles, row by row, those whose bit is set.
  uint64_t tiles = ~uint64_t{0};
};
void RenderBlockWide(const PacketScene& scene, const BlockTask& task, PacketWorkspace& workspace,
                     PacketCounts& counts);

}  // namespace linetree
