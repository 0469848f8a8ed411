// What is certain about the lights above a piece of surface (DESIGN: certified cells, light
// visibility over a patch). No sampling: shafts are convex hulls, and only a separating plane or a
// convex shadow decides.
//
// Why it holds. Every shading point of the piece lies in its patch hull H, and every shadow ray to
// a light at L in conv(H, L). An object that is certainly apart from that set, by a margin far
// above the tracer's rounding, is met by none of them. The points from which a convex object K
// hides L are L + s (K - L), s >= 1, a convex set; if it holds the eight points of H, it holds all
// of H. Directional lights are the limit: conv(H) + half line.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/trace/light_lists.h"
#include "core/trace/tracer.h"
#include "core/tree/candidate_search.h"
#include "core/tree/diffuse_sum.h"
#include "core/tree/surface_chart.h"

namespace linetree {

// The lights as seen from one piece of surface. Movable, not copyable: lists point into `objects`.
struct CellLights {
  CellLights() = default;
  CellLights(CellLights&&) = default;
  CellLights& operator=(CellLights&&) = default;

  std::vector<LightList> lights;
  std::vector<int32_t> objects;  // the candidates of all lights, one after the other
  // The diffuse light of those that are `summed`, on the outside or the side that a planar shape's
  // normal points to, and on its other side. Null: evaluate them one by one.
  std::array<std::unique_ptr<const DiffuseSum>, 2> sums;

  uint64_t HeapBytes() const {
    uint64_t bytes = lights.capacity() * sizeof(LightList) + objects.capacity() * sizeof(int32_t);
    for (const auto& sum : sums) bytes += sum ? sizeof(DiffuseSum) : 0;
    return bytes;
  }
  // Whether a smaller piece could know more.
  bool IsDecided() const;
};

class LightCertifier {
 public:
  // Keeps a reference to the tracer, which must outlive it.
  explicit LightCertifier(const Tracer& tracer);

  // Which it searches occluders with.
  const CandidateSearch& search() const { return search_; }

  // Knowledge about a piece of the given object. With `parent`, what is known of a larger piece
  // that contains it, only that one's candidates are looked at.
  CellLights Certify(int object, const PatchHull& hull, const CellLights* parent) const;

  // The same for one light without a parent, and without the candidates.
  LightKnowledge KnowledgeOf(int object, const PatchHull& hull, int light) const;

 private:
  struct Bundle;

  // What may block, as Candidates gives it, decides.
  LightKnowledge Decide(const Bundle& bundle, const std::vector<int32_t>& kept,
                        int32_t& occluder) const;
  std::vector<int32_t> Candidates(const Bundle& bundle, const LightList& inherited) const;
  bool MayBlock(const Bundle& bundle, int object) const;
  // Whether the object hides the light from every point of the hull.
  bool HidesAll(const Bundle& bundle, int object) const;

  const Tracer& tracer_;
  const Scene& scene_;
  Box3 world_;
  CandidateSearch search_;
};

}  // namespace linetree
