// Certified 4D cells (DESIGN, section 5): where the reflected and refracted rays of a cell go, and
// how far its interpolant can be from the truth.
//
// The centre ray of the cell is traced; corner jets of dimension 4 then follow the same surfaces
// for all rays of the cell at once. At every step
//   * which objects the rays can meet is a question to their hull (ray_bundle.h), of curved mirrors
//     and glass too, because jets enclose where rays start and end;
//   * whether all of them hit the same face, face the light or are reflected totally is the sign of
//     a jet, and "unknown" is never taken for yes.
// What stays unknown is left to the tracer and spoils nothing else. Whether a branch is cast at all
// (depth, weight) does not depend on the ray.
//
// The interpolant is made of the corner values of the jets of radiance. Its error is bounded by the
// interpolation lemma (corner_jet-inl.h), term by term, and storage in float is added.
#pragma once

#include <memory>
#include <vector>

#include "core/certify/cell_paths.h"
#include "core/certify/jet_shape.h"
#include "core/trace/tracer.h"
#include "core/tree/candidate_search.h"
#include "core/tree/light_certifier.h"
#include "core/tree/ray_space.h"

namespace linetree {

// A box in the coordinates of a face pair.
struct CellBox {
  RayCoords from{}, to{};
};
CellBox BoxOf(const CellId& cell);

// Steps of one cell; what lies beyond is unknown.
inline constexpr size_t kMaxPathSteps = 64;

class PathCertifier {
 public:
  // How jets are worked on: with the best vectors of this machine, or one number after the other.
  // Both give the same bits; the second is there to test the first.
  enum class Lanes { kSimd, kScalar };

  // Keeps a reference to the tracer, which must outlive it.
  explicit PathCertifier(const Tracer& tracer, Lanes lanes = Lanes::kSimd);

  // What is certain about the rays of the box that meet the object from outside. With `parent`,
  // what is known of a box that contains it, only that one's candidates are looked at.
  CellPaths Certify(int object, const ObjectChart& chart, int pair, const CellBox& box,
                    const PathLimits& limits, const CellPaths* parent) const;

  // What the parts of the certifier share.
  struct Context {
    explicit Context(const Tracer& tracer);
    const CandidateSearch& search() const { return lights.search(); }

    const Tracer& tracer;
    const Scene& scene;
    std::vector<JetShape> shapes;  // by object
    LightCertifier lights;
    Box3 world;
    double floor;  // radiance below which errors are not relative any more
  };

  // One cell to be certified.
  struct Task {
    int object = 0;
    LineForm form;
    CellBox box;
    Ray middle;  // the line through the middle of the box
    PathLimits limits;
    const CellPaths* parent = nullptr;
  };

 private:
  Context context_;
  Lanes lanes_;
};

// The two instances of path_walk-inl.h.
CellPaths CertifyPathsSimd(const PathCertifier::Context& context, const PathCertifier::Task& task);
CellPaths CertifyPathsScalar(const PathCertifier::Context& context,
                             const PathCertifier::Task& task);

}  // namespace linetree
