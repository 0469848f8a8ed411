// Whether a cell may answer. Judges are small, stateless values: pure functions of the scene and
// the extremal rays (DESIGN: two judges, same interface).
#pragma once

#include <array>
#include <memory>

#include "core/tree/corner_sample.h"
#include "core/tree/interpolant.h"
#include "core/tree/verdict.h"

namespace linetree {

using Corners = std::array<std::shared_ptr<const CornerSample>, kCellCorners>;

// What became of a cell, for every epsilon at once.
struct Judgement {
  // kCertified: the cell may answer any request whose epsilon is at least `spread`.
  Verdict verdict = Verdict::kUntried;
  // Largest relative difference of corner radiances, (max - min) / max(min, floor) over the three
  // channels, kStorageRounding included; meaningful when certified.
  double spread = 0;
  Interpolant interpolant{};  // filled when certified
};

class Judge {
 public:
  virtual ~Judge() = default;

  // A cheap refusal from two corners alone; kCertified when there is no reason to refuse yet. Lets
  // a builder stop before all sixteen are traced.
  virtual Verdict Compare(const CornerSample& first, const CornerSample& other) const = 0;

  // The judgement of the whole cell. All corners are set.
  virtual Judgement Decide(const Corners& corners) const = 0;
};

}  // namespace linetree
