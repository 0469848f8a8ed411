// Terms of curved cells for every target of Highway; which one runs is decided at run time.
//
// Everything ordinary is included here, before code for special targets is: nothing of it may be
// compiled for one.
#include "core/certify/curved_terms.h"
#include "core/certify/jet_shape.h"
#include "core/jet/interval.h"
#include "core/jet/simd_targets.h"
#include "core/scene/scene.h"

#define LINETREE_SIMD_JETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/certify/curved_terms_simd.cpp"
#include "hwy/foreach_target.h"
// After foreach_target.h.
#include "core/certify/curved_cell-inl.h"
#include "hwy/highway.h"

#if HWY_ONCE
namespace linetree {

HWY_EXPORT(FindCurvedTerms);

bool FindCurvedTermsSimd(const CurvedTask& task, CurvedTerm* terms) {
  return HWY_DYNAMIC_DISPATCH(FindCurvedTerms)(task, terms);
}

}  // namespace linetree
#endif
