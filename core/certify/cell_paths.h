// What is certain about the rays of one 4D cell: the payload of certified linetrees.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "core/trace/path_lists.h"
#include "core/tree/interpolant.h"
#include "core/tree/verdict.h"

namespace linetree {

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
