// Frames with several samples to a pixel, ray by ray.
#pragma once

#include "absl/status/status.h"
#include "core/render/answer_rays.h"
#include "core/render/frame.h"
#include "core/render/options.h"
#include "core/render/worker_pool.h"

namespace linetree {

// Fills in the frame, whose size, camera and sampling count, with the means of what AnswerRays says
// for its samples, and adds to its stats. CANCELLED when `cancel` said so.
absl::Status AnswerSamples(const Tracer& tracer, RadianceCache& cache, CertifiedTrees trees,
                           const RenderOptions& options, WorkerPool& pool,
                           const CancelToken* cancel, const Progress& progress, Frame& frame);

}  // namespace linetree
