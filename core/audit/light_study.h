// How many lights the surface trees leave undecided, and what their cells cost.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "core/render/worker_pool.h"
#include "core/scene/scene.h"

namespace linetree {

// Why a light that is on is in no diffuse sum, by what it falls on: a surface without diffuse
// light, a triangle with vertex normals (they lie on both sides, or the bound is too wide), a
// curved surface (the bound is too wide, or there is an apex), a plane (the lamp is near, or in
// it).
enum class Unsummed { kBlack, kVertexNormals, kCurved, kNear };
inline constexpr std::array<std::string_view, 4> kUnsummedNames = {"black", "vertex normals",
                                                                   "curved", "near"};

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
  // Lights that are on and in no sum, by reason (kUnsummedNames).
  std::array<uint64_t, kUnsummedNames.size()> unsummed{};
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
