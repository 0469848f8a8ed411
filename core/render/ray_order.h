// In which order the rays of a batch, and what they hit, go into packets: those of a packet are to
// keep together, in space and in direction. Pure functions; no answer depends on them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/math/box3.h"
#include "core/scene/camera.h"
#include "core/scene/scene.h"
#include "core/trace/hit.h"

namespace linetree {

// Whether sixteen rays that follow each other mostly keep together as they come: judged by
// kJudgedGroups of them, evenly spread over the batch. `bounds`: the scene's.
inline constexpr size_t kJudgedGroups = 64;
bool KeepTogether(std::span<const Ray> rays, const Box3& bounds);

// All indices of rays, along a curve that fills the space of rays (Z order; origins in 2^6 parts of
// the bounds, clamped to them, on every axis, directions in as many parts of both axes of the
// octahedral map). Rays of the same part stay in order. O(n).
std::vector<uint32_t> SortedRays(std::span<const Ray> rays, const Box3& bounds);

// The indices of what is hit, without misses: by object, by face, then along a curve through the
// object's bounds (Z order, 2^4 parts of every axis). Hits of the same part stay in order. O(n).
std::vector<uint32_t> BinnedHits(const Scene& scene, std::span<const Hit> hits);

}  // namespace linetree
