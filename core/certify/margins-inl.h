// How far from zero a jet must keep for its sign to be certain.
#if defined(LINETREE_CORE_CERTIFY_MARGINS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_CERTIFY_MARGINS_INL_H_
#undef LINETREE_CORE_CERTIFY_MARGINS_INL_H_
#else
#define LINETREE_CORE_CERTIFY_MARGINS_INL_H_
#endif

#include "core/jet/corner_jet-inl.h"

LINETREE_BEFORE_JETS();
namespace linetree::LINETREE_JETS {

// Every decision about a sign keeps away from zero by this share of the lengths involved, and by
// kDrift of what the quantity varies over the cell. The first covers the rounding of the classical
// tracer's own arithmetic (about 2^-48 of those lengths), the second what rounding earlier on the
// path has been blown up to by curved mirrors: a ray that is off by 2^-48 of the object's chart is
// off by 2^-48 / edge of a cell, so by 2^-33 of the variation over the smallest cell (edge 2^-15).
inline constexpr double kSignMargin = 0x1p-34;
inline constexpr double kDrift = 0x1p-30;

template <size_t D>
double MarginOf(const LooseJet<D>& f, double scale) {
  return kSignMargin * scale + kDrift * f.Variation();
}
template <size_t D>
bool IsPositive(const CornerJet<D>& f, double scale) {
  return f.lo() > MarginOf(f, scale);
}
template <size_t D>
bool IsNegative(const CornerJet<D>& f, double scale) {
  return f.hi() < -MarginOf(f, scale);
}

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
