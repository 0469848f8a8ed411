// Functions of corner jets: the chain rule on ranges, the function itself on corners.
#if defined(LINETREE_CORE_JET_JET_FUNCTIONS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_JET_JET_FUNCTIONS_INL_H_
#undef LINETREE_CORE_JET_JET_FUNCTIONS_INL_H_
#else
#define LINETREE_CORE_JET_JET_FUNCTIONS_INL_H_
#endif

#include <cmath>
#include <limits>

#include "core/jet/corner_jet-inl.h"

LINETREE_BEFORE_JETS();
namespace linetree::LINETREE_JETS {

using linetree::Inverse;
using linetree::Power;
using linetree::Square;
using linetree::SquareRoot;

// Corner values moved into the range, where f's own are: never farther from f than before.
template <size_t D>
Pack<CornerJet<D>::kCorners> CornersWithin(const CornerJet<D>& a) {
  using Corners = Pack<CornerJet<D>::kCorners>;
  return Max(Min(a.k, Corners::All(a.v.hi)), Corners::All(a.v.lo));
}

// A function of one variable over an interval: its range and those of its derivatives.
struct Function {
  Interval value, first, second;
};
// g(a), given g's ranges over a.v and its values at the corners, each to within `rounding` of them
// relative.
template <size_t D>
LooseJet<D> Compose(const CornerJet<D>& a, const Function& g,
                    const Pack<CornerJet<D>::kCorners>& corners, double rounding) {
  const auto first = IntervalPack<2 * D>::All(g.first);
  LooseJet<D> r;
  r.v = g.value;
  const IntervalPack<D> by_slopes = NearProduct(IntervalPack<D>::All(g.second), Square(a.d()));
  const IntervalPack<D> zero = IntervalPack<D>::All({0, 0});
  r.ds = SumOfNear(NearProduct(first, a.ds), Combine(zero, by_slopes));
  r.k = corners;
  r.slack = Above(g.first.Magnitude() * a.slack);
  r.slack = Above(r.slack + (g.value.Magnitude() + r.slack) * rounding +
                  std::numeric_limits<double>::denorm_min());
  return r;
}

// The same where g is a power, x^p: then g'' = g' (p - 1) / x, and hence
//   g(a)'' = g'(a) (a'' + (p - 1) a'^2 / a).
// The two terms in brackets, often of different signs, are added before they are multiplied by what
// varies: the chain rule as it stands takes the largest of both.
template <size_t D>
LooseJet<D> ComposePower(const CornerJet<D>& a, const Function& g, double p,
                         const Pack<CornerJet<D>::kCorners>& corners, double rounding) {
  LooseJet<D> r = Compose(a, g, corners, rounding);
  const Interval ratio = Inverse(a.v) * (p - 1);
  r.ds = Combine(r.d(), Meet(r.s(), g.first * (a.s() + ratio * Square(a.d()))));
  return r;
}

template <size_t D>
LooseJet<D> Square(const CornerJet<D>& a) {
  const auto k = CornersWithin(a);
  return Compose(a, Function{Square(a.v), a.v * 2.0, {2, 2}}, k * k, 2 * kOutward);
}
template <size_t D>
LooseJet<D> Square(const LooseJet<D>& a) {
  return Square(CornerJet<D>(a));
}
// 1 / a; the range keeps off 0.
template <size_t D>
CornerJet<D> Inverse(const CornerJet<D>& a) {
  const auto k = CornersWithin(a);
  const Interval value = Inverse(a.v);
  const Interval square = Square(value);
  const Function g{value, -square, square * value * 2.0};
  return ComposePower(a, g, -1, Pack<CornerJet<D>::kCorners>::All(1) / k, 2 * kOutward);
}
// lo > 0.
template <size_t D>
CornerJet<D> SquareRoot(const CornerJet<D>& a) {
  const Interval value = SquareRoot(a.v);
  const Interval inverse = Inverse(value);
  const Function g{value, inverse * 0.5, -(inverse * Square(inverse) * 0.25)};
  return ComposePower(a, g, 0.5, SquareRoot(CornersWithin(a)), 2 * kOutward);
}
// 1 / sqrt(a); lo > 0.
template <size_t D>
CornerJet<D> InverseSquareRoot(const CornerJet<D>& a) {
  using Corners = Pack<CornerJet<D>::kCorners>;
  const Interval value = Inverse(SquareRoot(a.v));
  const Interval square = Square(value);
  const Interval cube = value * square;
  const Function g{value, -(cube * 0.5), cube * square * 0.75};
  return ComposePower(a, g, -0.5, Corners::All(1) / SquareRoot(CornersWithin(a)), 4 * kOutward);
}
// Below, 1 / a says nothing of a power of it.
inline constexpr double kLeastBase = 0x1p-100;
// a^p; lo >= 0, and lo > 0 unless p >= 2 or p is 0 or 1: what the first two derivatives need.
template <size_t D>
CornerJet<D> Power(const CornerJet<D>& a, double p) {
  if (p == 0) return CornerJet<D>::Constant(1);
  if (p == 1) return a;
  double corners[CornerJet<D>::kCorners];
  CornersWithin(a).Store(corners);
  for (double& x : corners) x = std::pow(x, p);
  const Interval curvature = p == 2 ? Interval{1, 1} : Power(a.v, p - 2);
  const Function g{Power(a.v, p), Power(a.v, p - 1) * p, curvature * p * (p - 1)};
  const auto k = Pack<CornerJet<D>::kCorners>::Load(corners);
  if (!(a.v.lo > kLeastBase)) return Compose(a, g, k, kPowerRounding);
  return ComposePower(a, g, p, k, kPowerRounding);
}

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
