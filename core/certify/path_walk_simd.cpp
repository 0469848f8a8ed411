// The path walk for every target of Highway; which one runs is decided at run time.
//
// Everything ordinary is included here, before code for special targets is: nothing of it may be
// compiled for one.
#include "core/certify/cell_paths.h"
#include "core/certify/jet_shape.h"
#include "core/certify/path_certifier.h"
#include "core/certify/ray_bundle.h"
#include "core/jet/interval.h"
#include "core/jet/simd_targets.h"
#include "core/trace/shade.h"

#define LINETREE_SIMD_JETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/certify/path_walk_simd.cpp"
#include "hwy/foreach_target.h"
// After foreach_target.h.
#include "core/certify/path_walk-inl.h"
#include "hwy/highway.h"

#if HWY_ONCE
namespace linetree {

HWY_EXPORT(CertifyPaths);

CellPaths CertifyPathsSimd(const PathCertifier::Context& context, const PathCertifier::Task& task) {
  return HWY_DYNAMIC_DISPATCH(CertifyPaths)(context, task);
}

}  // namespace linetree
#endif
