// Sines and tangents of corner jets, for angles of a quarter turn, where they are monotone.
#if defined(LINETREE_CORE_JET_ANGLE_FUNCTIONS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_JET_ANGLE_FUNCTIONS_INL_H_
#undef LINETREE_CORE_JET_ANGLE_FUNCTIONS_INL_H_
#else
#define LINETREE_CORE_JET_ANGLE_FUNCTIONS_INL_H_
#endif

#include "core/jet/jet_functions-inl.h"

LINETREE_BEFORE_JETS();
namespace linetree::LINETREE_JETS {

// sin, cos and tan of the C library are within a unit in the last place; this is eight.
inline constexpr double kAngleRounding = 0x1p-49;

inline Interval WidenedBy(const Interval& a, double relative) {
  return Outward(a.lo - std::abs(a.lo) * relative, a.hi + std::abs(a.hi) * relative);
}

template <size_t D, class Fn>
CornerJet<D> ComposeAt(const CornerJet<D>& a, const Function& g, Fn&& at) {
  double corners[CornerJet<D>::kCorners];
  CornersWithin(a).Store(corners);
  for (double& x : corners) x = at(x);
  return Compose(a, g, Pack<CornerJet<D>::kCorners>::Load(corners), kAngleRounding);
}

// For angles in [0, pi/2].
template <size_t D>
CornerJet<D> Sine(const CornerJet<D>& a) {
  const Interval sine = WidenedBy({std::sin(a.v.lo), std::sin(a.v.hi)}, kAngleRounding);
  const Interval cosine = WidenedBy({std::cos(a.v.hi), std::cos(a.v.lo)}, kAngleRounding);
  return ComposeAt(a, {sine, cosine, -sine}, [](double x) { return std::sin(x); });
}
template <size_t D>
CornerJet<D> Cosine(const CornerJet<D>& a) {
  const Interval sine = WidenedBy({std::sin(a.v.lo), std::sin(a.v.hi)}, kAngleRounding);
  const Interval cosine = WidenedBy({std::cos(a.v.hi), std::cos(a.v.lo)}, kAngleRounding);
  return ComposeAt(a, {cosine, -sine, -cosine}, [](double x) { return std::cos(x); });
}
// For angles in [-pi/4, pi/4].
template <size_t D>
CornerJet<D> Tangent(const CornerJet<D>& a) {
  const Interval value = WidenedBy({std::tan(a.v.lo), std::tan(a.v.hi)}, kAngleRounding);
  const Interval first = Square(value) + 1.0;
  return ComposeAt(a, {value, first, value * first * 2.0}, [](double x) { return std::tan(x); });
}

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
