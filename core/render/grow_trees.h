// How surface trees grow while packets are answered: only where a planner, which counts work, finds
// that it pays.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/cache/parallel_loop.h"
#include "core/cache/surface_cache.h"
#include "core/frame/frame_plan.h"
#include "core/scene/scene.h"

namespace linetree {

// What is learnt for the requests to come is to be worth its price within so many like this one;
// what is built for the rest of one, eight times its price within that one: savings are promised
// before they are known.
inline constexpr double kLearningHorizon = 6;
inline constexpr double kSureHorizon = 1.0 / 8;
// Of what cells are known to save in the rest of a request, so much may be spent on more of them.
inline constexpr double kReinvested = 0.5;

// Packets of a block: one in so many is booked in the plan.
inline constexpr size_t kBlockPackets = 64;

// What has just been asked for, and what it may cost.
struct Growth {
  double weight;       // shading points that one use stands for
  double booked;       // and one that is booked
  double horizon;      // a cell is worth its price within so many requests like this one
  double most_work;    // what they may cost together: those that most points ask for come first
  bool ahead = false;  // as RenderOptions::ahead
};

// Certifies the cells that pay for themselves.
SurfaceCache::Grown GrowTrees(const Scene& scene, SurfaceCache& surfaces, FramePlan& plan,
                              const Growth& growth, const ParallelLoop& loop);

// Of a request's work (kRayWork for each of its rays, and what lights cost without trees), what may
// be spent on cells, beyond what they earn.
inline constexpr double kLearningShare = 0.03;
inline constexpr double kRayWork = 10;

}  // namespace linetree
