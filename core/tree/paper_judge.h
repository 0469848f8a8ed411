// The paper's judge (sections 5 and 7): sixteen hits, isomorphic ray trees, no dense-to-sparse
// interface, no possible blocker in the shaft of any ray bundle, no highlight between the extremal
// rays, radiances within epsilon.
//
// It is a heuristic: measured, it errs in about 5e-5 of the cells it accepts in scenes of disjoint
// objects and several times as often where surfaces abut (DESIGN: two kinds of tree).
#pragma once

#include <optional>

#include "core/tree/judge.h"

namespace linetree {

class PaperJudge : public Judge {
 public:
  // Keeps a reference to the tracer, which must outlive the judge.
  explicit PaperJudge(const Tracer& tracer)
      : tracer_(tracer), scene_(tracer.scene()), world_(scene_.WorldBounds()) {}

  Verdict Compare(const CornerSample& first, const CornerSample& other) const override;
  Judgement Decide(const Corners& corners) const override;

 private:
  // Each looks for one source of aliasing and returns its verdict, or kCertified.
  Verdict FindFunnel(const Corners& corners) const;
  Verdict FindBlocker(const Corners& corners) const;
  Verdict FindPeak(const Corners& corners) const;
  // By how much diffuse terms may exceed their largest extremal value inside the cell: where
  // normals and light directions are not separable, n.l may reach 1. Empty when no bound is known
  // (a light with fall-off).
  std::optional<Rgb> DiffuseRise(const Corners& corners) const;
  Rgb WeightOf(const RayTree& tree, size_t node) const;

  Verdict BlockedBranch(const Corners& corners, size_t node) const;
  Verdict BlockedLight(const Corners& corners, size_t node, int light) const;
  bool HaveCommonOccluder(const Corners& corners, size_t node, int light) const;
  bool AllCross(const Corners& corners, size_t node, int light, int object) const;
  // Whether an object other than the two given ones may reach into the shaft. `is_harmless` may
  // exempt further objects.
  template <class F>
  bool ShaftHolds(const Box3& from, const Box3& to, int self, int target, F is_harmless) const;
  Vec3d FarPoint(const Vec3d& origin, const Vec3d& direction) const;

  const Tracer& tracer_;
  const Scene& scene_;
  Box3 world_;
};

}  // namespace linetree
