// Corner jets: a smooth function on a cell, known by its values at the cell's corners, its range,
// and the ranges of its first and pure second derivatives (DESIGN, section 5).
//
// Coordinates u run over [0,1]^D in every cell, so derivatives are per cell edge and a jet knows no
// lengths. For f on the cell the jet holds
//   k_m   f at corner m (bit i of m: at which end of axis i), each to within `slack`,
//   v     an interval that contains f,
//   d_i   intervals that contain df/du_i, s_i intervals that contain d2f/du_i^2, i < D.
//
// The lemma behind it all. Let Q be the multilinear interpolant of f's corners. Then
//   Q - f  lies in  [ -sum_i U_i, sum_i L_i ],  U_i = max(0, -inf s_i) / 8, L_i = max(0, sup s_i)
//   / 8.
// For D = 1 that is the classical error of linear interpolation, f(x) - Q(x) = f''(xi) x (x-1) / 2.
// For more axes write I_i for interpolation along axis i; then Q = I_1 ... I_D f and
//   f - Q = (f - I_1 f) + I_1 (f - I_2 f) + ... + I_1 ... I_{D-1} (f - I_D f).
// Each bracket is an error of one dimension, and I_i takes weighted means, which keep bounds. No
// mixed derivative appears. Hence also
//   f  in  [min k - sum L, max k + sum U],
//   df/du_i  in  [min, max] of the corner slopes along i  -+  ( sum_{j != i} (U_j + L_j) + sup|s_i|
//   / 2 ),
// the latter because the slope of the chord over axis i is a difference of two values of f, each of
// which interpolation over the other axes misses by at most -U, +L, and because f_i differs from
// the chord's slope by at most sup|s_i| * integral |u - t| dt <= sup|s_i| / 2.
// After every operation these replace the ranges where they are narrower (Tighten): the chain rule
// alone would blow up (dependency), the corners do not.
//
// Rounding: ranges are rounded outwards; `slack` bounds what the corner values have lost.
#include "core/jet/pack-inl.h"

#ifndef LINETREE_CORE_JET_CORNER_JET_INL_H_
#define LINETREE_CORE_JET_CORNER_JET_INL_H_

namespace linetree::LINETREE_JETS {

using linetree::Inverse;
using linetree::Meet;
using linetree::Outward;
using linetree::Power;
using linetree::Square;
using linetree::SquareRoot;

// Intervals in lanes.
template <size_t N>
struct IntervalPack {
  Pack<N> lo, hi;

  static IntervalPack All(const Interval& a) { return {Pack<N>::All(a.lo), Pack<N>::All(a.hi)}; }
};
template <size_t N>
Pack<N> StepOf(const Pack<N>& a) {
  return Abs(a) * Pack<N>::All(kOutward) + Pack<N>::All(std::numeric_limits<double>::denorm_min());
}
template <size_t N>
IntervalPack<N> Outward(const Pack<N>& lo, const Pack<N>& hi) {
  return {lo - StepOf(lo), hi + StepOf(hi)};
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
IntervalPack<N> operator*(const IntervalPack<N>& a, const IntervalPack<N>& b) {
  const Pack<N> p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
  return Outward(Min(Min(p, q), Min(r, s)), Max(Max(p, q), Max(r, s)));
}
template <size_t N>
IntervalPack<N> Square(const IntervalPack<N>& a) {
  const Pack<N> zero = Pack<N>::All(0);
  const Pack<N> p = a.lo * a.lo, q = a.hi * a.hi;
  // inf |a| is 0 where a contains 0.
  const Pack<N> nearest = Max(zero, Max(a.lo, -a.hi));
  const Pack<N> least = nearest * nearest, most = Max(p, q);
  return {Max(zero, least - StepOf(least)), most + StepOf(most)};
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
template <size_t N>
double SumOfLanes(const Pack<N>& a) {
  double lanes[N];
  a.Store(lanes);
  double sum = 0;
  for (size_t i = 0; i < N; ++i) sum += lanes[i];
  return sum;
}

// A sum or product of at most sixteen rounded terms, none negative, as an upper bound.
inline double Above(double x) { return x * (1 + 16 * kOutward); }

template <size_t D>
struct CornerJet {
  static constexpr size_t kCorners = size_t{1} << D;

  Interval v;
  IntervalPack<D> d, s;
  Pack<kCorners> k;
  double slack = 0;

  static CornerJet Constant(double c) {
    CornerJet jet;
    jet.v = {c, c};
    jet.d = jet.s = IntervalPack<D>::All({0, 0});
    jet.k = Pack<kCorners>::All(c);
    return jet;
  }
  // The coordinate that runs from `from` to `to` along one axis.
  static CornerJet Variable(size_t axis, double from, double to) {
    CornerJet jet = Constant(from);
    jet.v = {std::min(from, to), std::max(from, to)};
    double corners[kCorners], lo[D] = {}, hi[D] = {};
    for (size_t m = 0; m < kCorners; ++m) corners[m] = (m >> axis & 1) != 0 ? to : from;
    lo[axis] = RoundDown(to - from);
    hi[axis] = RoundUp(to - from);
    jet.k = Pack<kCorners>::Load(corners);
    jet.d = {Pack<D>::Load(lo), Pack<D>::Load(hi)};
    return jet;
  }

  double lo() const { return v.lo; }
  double hi() const { return v.hi; }
  // Bounds on the excess of f over Q and of Q over f, without slack: sum U and sum L.
  double ExcessOverQ() const { return Above(SumOfLanes(CurvatureDown()) / 8); }
  double ExcessUnderQ() const { return Above(SumOfLanes(CurvatureUp()) / 8); }
  // |Q - f|, Q made of the corner values held here.
  double InterpolationError() const {
    return RoundUp(Above(SumOfLanes(Magnitudes(s)) / 8) + slack);
  }
  // Sum of sup |df/du_i|: how far f can be from one end of the cell to the other.
  double Variation() const { return Above(SumOfLanes(Magnitudes(d))); }

  // Something else is known of f's range.
  void AssumeWithin(double least, double most) {
    v = {std::clamp(v.lo, least, most), std::clamp(v.hi, least, most)};
  }
  // f is known to be concave along every axis.
  void AssumeConcave() {
    const Pack<D> zero = Pack<D>::All(0);
    s.hi = Min(s.hi, zero);
    s.lo = Min(s.lo, s.hi);
    Tighten();
  }

  void Tighten() {
    const Pack<D> up = CurvatureDown(), down = CurvatureUp();
    const double eighth = 0.125;
    const double sum_up = Above(SumOfLanes(up) * eighth);
    const double sum_down = Above(SumOfLanes(down) * eighth);
    const double least = SmallestLane(k), most = LargestLane(k);
    v = Meet(v, Outward(RoundDown(least - sum_down) - slack, RoundUp(most + sum_up) + slack));
    TightenSlopes(up, down, sum_up + sum_down);
  }

 private:
  Pack<D> CurvatureDown() const { return Max(Pack<D>::All(0), -s.lo); }
  Pack<D> CurvatureUp() const { return Max(Pack<D>::All(0), s.hi); }

  void TightenSlopes(const Pack<D>& up, const Pack<D>& down, double total) {
    double least[D], most[D];
    SlopeRange<0>(least, most);
    // sum_{j != i} (U_j + L_j) + |s_i|/2 + what the slopes themselves have lost.
    const Pack<D> others = Pack<D>::All(Above(total)) - (up + down) * Pack<D>::All(0.125);
    const double lost = 2 * slack + 8 * kOutward * (v.Magnitude() + slack);
    const Pack<D> wide = Max(Pack<D>::All(0), others) + Max(up, down) * Pack<D>::All(0.5) +
                         Pack<D>::All(Above(lost + total * 4 * kOutward));
    d = Meet(d, Outward(Pack<D>::Load(least) - wide, Pack<D>::Load(most) + wide));
  }
  template <size_t Axis>
  void SlopeRange(double* least, double* most) const {
    if constexpr (Axis < D) {
      const Pack<kCorners> slopes = Slopes<Axis>(k);
      least[Axis] = SmallestLane(slopes);
      most[Axis] = LargestLane(slopes);
      SlopeRange<Axis + 1>(least, most);
    }
  }
};

// What one more rounded operation costs the corner values of a result in `range`.
inline double RoundingOf(const Interval& range, double slack) {
  return (range.Magnitude() + slack) * kOutward + std::numeric_limits<double>::denorm_min();
}

template <size_t D>
CornerJet<D> operator-(const CornerJet<D>& a) {
  CornerJet<D> r;
  r.v = -a.v;
  r.d = -a.d;
  r.s = -a.s;
  r.k = -a.k;
  r.slack = a.slack;
  return r;
}
template <size_t D>
CornerJet<D> operator+(const CornerJet<D>& a, const CornerJet<D>& b) {
  CornerJet<D> r;
  r.v = a.v + b.v;
  r.d = a.d + b.d;
  r.s = a.s + b.s;
  r.k = a.k + b.k;
  r.slack = Above(a.slack + b.slack);
  r.slack = Above(r.slack + RoundingOf(r.v, r.slack));
  r.Tighten();
  return r;
}
template <size_t D>
CornerJet<D> operator-(const CornerJet<D>& a, const CornerJet<D>& b) {
  return a + -b;
}
template <size_t D>
CornerJet<D> operator+(const CornerJet<D>& a, double c) {
  CornerJet<D> r = a;
  r.v = a.v + c;
  r.k = a.k + Pack<CornerJet<D>::kCorners>::All(c);
  r.slack = Above(a.slack + RoundingOf(r.v, a.slack));
  return r;
}
template <size_t D>
CornerJet<D> operator*(const CornerJet<D>& a, double c) {
  const Interval factor{c, c};
  const IntervalPack<D> factors = IntervalPack<D>::All(factor);
  CornerJet<D> r;
  r.v = a.v * factor;
  r.d = a.d * factors;
  r.s = a.s * factors;
  r.k = a.k * Pack<CornerJet<D>::kCorners>::All(c);
  r.slack = Above(a.slack * std::abs(c));
  r.slack = Above(r.slack + RoundingOf(r.v, r.slack));
  return r;
}
// (ab)'' = a b'' + b a'' + 2 a' b'.
template <size_t D>
CornerJet<D> operator*(const CornerJet<D>& a, const CornerJet<D>& b) {
  const IntervalPack<D> va = IntervalPack<D>::All(a.v), vb = IntervalPack<D>::All(b.v);
  const IntervalPack<D> both = a.d * b.d;
  CornerJet<D> r;
  r.v = a.v * b.v;
  r.d = va * b.d + vb * a.d;
  r.s = va * b.s + vb * a.s + (both + both);
  r.k = a.k * b.k;
  r.slack = Above(a.v.Magnitude() * b.slack + b.v.Magnitude() * a.slack + a.slack * b.slack);
  r.slack = Above(r.slack + RoundingOf(r.v, r.slack));
  r.Tighten();
  return r;
}

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
CornerJet<D> Compose(const CornerJet<D>& a, const Function& g,
                     const Pack<CornerJet<D>::kCorners>& corners, double rounding) {
  const IntervalPack<D> first = IntervalPack<D>::All(g.first);
  CornerJet<D> r;
  r.v = g.value;
  r.d = first * a.d;
  r.s = IntervalPack<D>::All(g.second) * Square(a.d) + first * a.s;
  r.k = corners;
  r.slack = Above(g.first.Magnitude() * a.slack);
  r.slack = Above(r.slack + (g.value.Magnitude() + r.slack) * rounding +
                  std::numeric_limits<double>::denorm_min());
  r.Tighten();
  return r;
}

template <size_t D>
CornerJet<D> Square(const CornerJet<D>& a) {
  const auto k = CornersWithin(a);
  return Compose(a, Function{Square(a.v), a.v * 2.0, {2, 2}}, k * k, 2 * kOutward);
}
// 1 / a; the range keeps off 0.
template <size_t D>
CornerJet<D> Inverse(const CornerJet<D>& a) {
  const auto k = CornersWithin(a);
  const Interval value = Inverse(a.v);
  const Interval square = Square(value);
  const Function g{value, -square, square * value * 2.0};
  return Compose(a, g, Pack<CornerJet<D>::kCorners>::All(1) / k, 2 * kOutward);
}
// lo > 0.
template <size_t D>
CornerJet<D> SquareRoot(const CornerJet<D>& a) {
  const Interval value = SquareRoot(a.v);
  const Interval inverse = Inverse(value);
  const Function g{value, inverse * 0.5, -(inverse * Square(inverse) * 0.25)};
  return Compose(a, g, SquareRoot(CornersWithin(a)), 2 * kOutward);
}
// 1 / sqrt(a); lo > 0.
template <size_t D>
CornerJet<D> InverseSquareRoot(const CornerJet<D>& a) {
  using Corners = Pack<CornerJet<D>::kCorners>;
  const Interval value = Inverse(SquareRoot(a.v));
  const Interval square = Square(value);
  const Interval cube = value * square;
  const Function g{value, -(cube * 0.5), cube * square * 0.75};
  return Compose(a, g, Corners::All(1) / SquareRoot(CornersWithin(a)), 4 * kOutward);
}
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
  return Compose(a, g, Pack<CornerJet<D>::kCorners>::Load(corners), kPowerRounding);
}

}  // namespace linetree::LINETREE_JETS

#endif
