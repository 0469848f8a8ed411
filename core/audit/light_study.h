// How many lights the surface trees leave undecided, and what their cells cost.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/render/worker_pool.h"
#include "core/scene/scene.h"

namespace linetree {

struct LightStudyRow {
  size_t lights = 0;
  bool functions = true;        // whether planar cells have shadow functions
  uint64_t covered = 0;         // pixels that show an object
  uint64_t nearly_decided = 0;  // of these: at most one light that the surface faces is undecided
  // Lights that surfaces face, summed over pixels:
  uint64_t decided = 0;
  uint64_t undecided = 0;
  uint64_t candidates = 0;  // of the undecided ones
  uint64_t answered = 0;    // of these candidates: by their function
  uint64_t cells = 0;
  uint64_t bytes = 0;
  double cell_us = 0;  // microseconds a cell, one thread
};

// The scene with `count` lights instead of its own, of equal total strength, on a grid below the
// top (y) of its bounds; with its own when count is not larger than their number.
std::shared_ptr<const Scene> WithLights(const Scene& scene, size_t count);

// Surface trees as one camera's frames of side x side pixels leave them; cells of fewer than
// `min_footprint` pixels are not divided. With or without shadow functions.
LightStudyRow StudyLights(const Scene& scene, const Camera& camera, int side, double min_footprint,
                          bool functions, WorkerPool& pool);

}  // namespace linetree
