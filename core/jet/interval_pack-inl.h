// Intervals in lanes: interval.h on packs.
#if defined(LINETREE_CORE_JET_INTERVAL_PACK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_JET_INTERVAL_PACK_INL_H_
#undef LINETREE_CORE_JET_INTERVAL_PACK_INL_H_
#else
#define LINETREE_CORE_JET_INTERVAL_PACK_INL_H_
#endif

#include <limits>

#include "core/jet/interval.h"
#include "core/jet/pack-inl.h"

LINETREE_BEFORE_JETS();
namespace linetree::LINETREE_JETS {

using linetree::Meet;
using linetree::Outward;

template <size_t N>
struct IntervalPack {
  Pack<N> lo, hi;

  static IntervalPack All(const Interval& a) { return {Pack<N>::All(a.lo), Pack<N>::All(a.hi)}; }
};

template <size_t N>
IntervalPack<N / 2> LowerHalf(const IntervalPack<N>& a) {
  return {LowerHalf(a.lo), LowerHalf(a.hi)};
}
template <size_t N>
IntervalPack<N / 2> UpperHalf(const IntervalPack<N>& a) {
  return {UpperHalf(a.lo), UpperHalf(a.hi)};
}
template <size_t N>
IntervalPack<2 * N> Combine(const IntervalPack<N>& lower, const IntervalPack<N>& upper) {
  return {Combine(lower.lo, upper.lo), Combine(lower.hi, upper.hi)};
}

// Room for the rounding of what has gone through `steps` operations whose terms have sizes up to
// `size`, and of the step itself.
template <size_t N>
Pack<N> StepOf(const Pack<N>& size, double steps = 1) {
  return size * Pack<N>::All(steps * kOutward) +
         Pack<N>::All(steps * std::numeric_limits<double>::denorm_min());
}
template <size_t N>
IntervalPack<N> Outward(const Pack<N>& lo, const Pack<N>& hi) {
  return {lo - StepOf(Abs(lo)), hi + StepOf(Abs(hi))};
}

template <size_t N>
IntervalPack<N> operator-(const IntervalPack<N>& a) {
  return {-a.hi, -a.lo};
}
template <size_t N>
IntervalPack<N> operator+(const IntervalPack<N>& a, const IntervalPack<N>& b) {
  return Outward(a.lo + b.lo, a.hi + b.hi);
}
template <size_t N>
IntervalPack<N> operator*(const IntervalPack<N>& a, double c) {
  const Pack<N> p = a.lo * Pack<N>::All(c), q = a.hi * Pack<N>::All(c);
  return c < 0 ? Outward(q, p) : Outward(p, q);
}

// A product, rounded to the nearest: not yet an enclosure.
template <size_t N>
IntervalPack<N> NearProduct(const IntervalPack<N>& a, const IntervalPack<N>& b) {
  const Pack<N> p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
  return {Min(Min(p, q), Min(r, s)), Max(Max(p, q), Max(r, s))};
}
template <size_t N>
IntervalPack<N> operator*(const Interval& c, const IntervalPack<N>& a) {
  const IntervalPack<N> product = NearProduct(IntervalPack<N>::All(c), a);
  return Outward(product.lo, product.hi);
}

template <size_t N>
IntervalPack<N> Square(const IntervalPack<N>& a) {
  const Pack<N> zero = Pack<N>::All(0);
  // inf |a| is 0 where a contains 0.
  const Pack<N> nearest = Max(zero, Max(a.lo, -a.hi)), farthest = Max(-a.lo, a.hi);
  const Pack<N> least = nearest * nearest, most = farthest * farthest;
  return {Max(zero, least - StepOf(least)), most + StepOf(most)};
}

// Encloses the sum of two or three near products. Each of them is off by half a step of its own
// size; every addition, and the move outwards, is by half a step of the sum.
template <size_t N>
IntervalPack<N> SumOfNear(const IntervalPack<N>& a, const IntervalPack<N>& b) {
  return {(a.lo + b.lo) - StepOf(Abs(a.lo) + Abs(b.lo), 2),
          (a.hi + b.hi) + StepOf(Abs(a.hi) + Abs(b.hi), 2)};
}
template <size_t N>
IntervalPack<N> SumOfNear(const IntervalPack<N>& a, const IntervalPack<N>& b,
                          const IntervalPack<N>& c) {
  return {(a.lo + b.lo + c.lo) - StepOf(Abs(a.lo) + Abs(b.lo) + Abs(c.lo), 3),
          (a.hi + b.hi + c.hi) + StepOf(Abs(a.hi) + Abs(b.hi) + Abs(c.hi), 3)};
}

template <size_t N>
IntervalPack<N> Meet(const IntervalPack<N>& a, const IntervalPack<N>& b) {
  const Pack<N> lo = Max(a.lo, b.lo), hi = Min(a.hi, b.hi);
  return {Min(lo, hi), Max(lo, hi)};
}
template <size_t N>
Pack<N> Magnitudes(const IntervalPack<N>& a) {
  return Max(-a.lo, a.hi);
}

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
