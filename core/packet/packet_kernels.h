// The packet tracer's work, compiled for every target of Highway. What each does is said in
// packet_tracer.h; the scene is usable().
#pragma once

#include <span>

#include "core/packet/packet_tracer.h"
#include "core/scene/pixel_samples.h"

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

// What all rays of a tile meet first, where that is known: a face, or nothing (kNoObject). `code`:
// as Nearest has it.
struct SeenFace {
  int32_t object = kNoObject;
  int32_t code = 0;
  bool is_known = false;
};

// A region of at most kBlockSide pixels a side.
struct BlockTask {
  const EyeRays& eye_rays;
  PacketTracer::Region region;  // of the image
  const PathLimits& limits;
  size_t stride;
  const PixelTarget& target;
  // Whether squares of pixels are looked at as a whole first.
  bool sees_squares;
  // Of the region's tiles, row by row, those whose bit is set.
  uint64_t tiles = ~uint64_t{0};
  // Pixels are cells of these, counted in the finer image that `eye_rays` are those of.
  const PixelSamples* samples = nullptr;
  int left = 0, top = 0;           // the image's pixel that the target begins with
  const SeenFace* seen = nullptr;  // by tile
};
void RenderBlockWide(const PacketScene& scene, const BlockTask& task, PacketWorkspace& workspace,
                     PacketCounts& counts);

// What a ray carries, and what it hits.
struct RayResult {
  double depth = 0;  // distance along the ray, where something is hit
  float radiance[3] = {};
  int32_t object = kNoObject;
  uint8_t uses = 0;  // PixelUse
};

// At most kBlockPixels rays of a batch, sixteen to a packet in the order of `block`.
struct RayTask {
  std::span<const Ray> rays;        // the batch; of unit direction
  std::span<const Hit> hits;        // of all rays, if they are known; empty if not
  std::span<const uint32_t> block;  // indices into the batch; where hits are known, all have one
  std::span<RayResult> results;     // one for every entry of the block
  const PathLimits& limits;
};
void TraceRayBlockWide(const PacketScene& scene, const RayTask& task, PacketWorkspace& workspace,
                       PacketCounts& counts);
// What these rays of a batch hit, no more; hits[i] is that of rays[i].
void FindRayHitsWide(const PacketScene& scene, std::span<const Ray> rays,
                     std::span<const uint32_t> block, std::span<Hit> hits, PacketCounts& counts);

}  // namespace linetree
