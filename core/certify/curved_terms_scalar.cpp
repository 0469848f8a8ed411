// Terms of curved cells without SIMD: the plain twin.
#include "core/certify/curved_cell-inl.h"
#include "core/certify/curved_terms.h"

namespace linetree {

bool FindCurvedTermsScalar(const CurvedTask& task, CurvedTerm* terms) {
  return scalar_jets::FindCurvedTerms(task, terms);
}

}  // namespace linetree
