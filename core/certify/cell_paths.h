// What is certain about the rays of one 4D cell: the payload of certified linetrees.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <string_view>
#include <vector>

#include "core/scene/scene.h"
#include "core/trace/path_lists.h"
#include "core/tree/interpolant.h"
#include "core/tree/verdict.h"

namespace linetree {

// A hit is off by some 2^-52 of the distance from which its ray comes. Certificates allow for that
// of rays from as far away as the object is from the world's origin, or 256 times its own size
// (IsAboveRounding in margins-inl.h): farther ones, which see it as a pixel or two, are left to the
// tracer. World length.
inline double MaxHitDistance(const Object& object) {
  const double size = Length(object.bounds.Extent());
  return std::max(256 * size, size + Length(object.bounds.Center()));
}

// Why not all rays of a cell certainly meet the same surfaces and lights.
enum class Doubt : uint8_t {
  kNone,
  kFirstFace,   // rays may meet other faces of the object, or pass it
  kBranchFace,  // reflected or refracted rays may meet other faces than the centre ray does
  kBetween,     // an object may come between the ends of a branch
  kRefraction,  // some rays may be reflected totally, or the medium around is not certain
  kShadow,      // a light may be hidden from some hits and not from others
  kBound,       // a highlight or the place of a hit has no finite bound
  kTooLong,     // more than kMaxPathSteps branches
};
inline constexpr int kDoubtCount = 8;
inline constexpr std::array<std::string_view, kDoubtCount> kDoubtNames = {
    "none", "first_face", "branch_face", "between", "refraction", "shadow", "bound", "too_long"};

// Movable, not copyable: steps point into `objects`.
struct CellPaths {
  CellPaths() = default;
  CellPaths(CellPaths&&) = default;
  CellPaths& operator=(CellPaths&&) = default;

  // steps[0] stands for the cell's rays themselves, up to their first hit; empty where nothing is
  // certain, not even that.
  std::vector<PathStep> steps;
  std::vector<int32_t> objects;  // the candidates of all steps, one after the other

  // kCertified: every ray meets the same surfaces and sees the same lights, `spread` bounds the
  // interpolant's error. Otherwise the first reason why not, and only `steps` may be used.
  Verdict verdict = Verdict::kUntried;
  Doubt doubt = Doubt::kNone;  // the same reason, in more detail
  // Largest |interpolant - classical| / max(classical, floor) over the three channels, proved.
  double spread = std::numeric_limits<double>::infinity();
  std::unique_ptr<Interpolant> interpolant;

  // Whether a smaller cell could know more of where the rays go.
  bool IsDecided() const { return decided; }
  bool decided = false;

  // Whether it saves any search.
  bool ListsAnything() const {
    return std::any_of(steps.begin(), steps.end(), [](const PathStep& s) { return s.listed; });
  }

  uint64_t HeapBytes() const {
    return steps.capacity() * sizeof(PathStep) + objects.capacity() * sizeof(int32_t) +
           (interpolant ? sizeof(Interpolant) : 0);
  }
};

}  // namespace linetree
