// How far from zero a jet must keep for its sign to be certain.
#if defined(LINETREE_CORE_CERTIFY_MARGINS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_CERTIFY_MARGINS_INL_H_
#undef LINETREE_CORE_CERTIFY_MARGINS_INL_H_
#else
#define LINETREE_CORE_CERTIFY_MARGINS_INL_H_
#endif

#include "core/jet/jet_vector-inl.h"

LINETREE_BEFORE_JETS();
namespace linetree::LINETREE_JETS {

// Every decision about a sign keeps away from zero by this share of the lengths involved, and by
// kDrift of what the quantity varies over the cell. The first covers the rounding of the classical
// tracer's own arithmetic (about 2^-48 of those lengths), the second what rounding earlier on the
// path has been blown up to by curved mirrors: what one hit is off by, kHitRounding of its
// coordinates, is a share of the cell's width there, and about that share of the variation of all
// that follows. Branches are followed only where that share is less than kDrift. How hits, widths
// and variations are turned to each other is not part of the derivation; climbing over chains of
// mirrors (margins_test.cpp) uses up a 28th of both margins, and 4 times of them without that rule.
inline constexpr double kSignMargin = 0x1p-34;
inline constexpr double kDrift = 0x1p-24;
// Of coordinates: 4 u.
inline constexpr double kHitRounding = 0x1p-51;

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

// Whether a cell is so wide at its hits, with coordinates there and distances to where the rays
// begin up to `reach`, that what the classical tracer's are off by is less than kDrift of it. Where
// it is not, as on small mirrors far from the world's origin, margins do not hold for what branches
// meet.
template <size_t D>
bool IsAboveRounding(const JetVector<D>& hits, double reach) {
  const CornerJet<D>* point[3] = {&hits.x, &hits.y, &hits.z};
  double by[3][D];
  for (size_t i = 0; i < 3; ++i) {
    double lo[D], hi[D];
    point[i]->d().lo.Store(lo);
    point[i]->d().hi.Store(hi);
    for (size_t k = 0; k < D; ++k) by[i][k] = (lo[k] + hi[k]) / 2;
  }
  const auto product = [&](size_t i, size_t j) {
    double sum = 0;
    for (size_t k = 0; k < D; ++k) sum += by[i][k] * by[j][k];
    return sum;
  };
  // Of the squares of the widths across the surface (the third, along the normal, is near 0): the
  // sum, and the sum of the products by pairs, whose quotient is below the smaller one.
  double squares = 0, products = 0;
  for (size_t i = 0; i < 3; ++i) {
    const size_t j = (i + 1) % 3;
    const double mixed = product(i, j);
    squares += product(i, i);
    products += product(i, i) * product(j, j) - mixed * mixed;
  }
  const double least = kHitRounding * reach / kDrift;
  return products > squares * least * least;
}

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
