// Blocks of pixels that have several samples each, by packets: a few pixels at a time, whose
// samples are a block of the finer image (PixelSamples).
#pragma once

#include <functional>

#include "core/frame/frame_kernels.h"
#include "core/render/frame.h"
#include "core/render/tile_sources.h"

namespace linetree {

struct SampledFrame {
  const PixelSamples& samples;
  const EyeRays& eye_rays;  // of the finer image
  const PathLimits& limits;
  bool sees_squares;
  bool asked;  // see StoreSources
  Frame& frame;
};

// Renders a block of the finer image into the task's target, and returns its uses
// (PacketWorkspace::uses).
using RenderSamples = std::function<const uint8_t*(const BlockTask& task)>;

// Fills in the pixels of the region, at most kBlockSide a side, and counts the sources of their
// samples. The finer image is never held but for the samples of a few pixels. `once`: what has been
// evaluated already, null for nothing.
void RenderSampledBlock(const SampledFrame& sampled, const PacketTracer::Region& region,
                        const RenderSamples& render, const OnceBlock* once, UseCounts& counts);

}  // namespace linetree
