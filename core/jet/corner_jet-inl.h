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
// These replace the ranges where they are narrower (Tighten): the chain rule alone would blow up
// (dependency), the corners do not. It is done once for every sum of products, when it is given a
// name: sums and products are LooseJets, and turning one into a CornerJet tightens it. Functions
// and products take CornerJets.
//
// Rounding: ranges are rounded outwards; `slack` bounds what the corner values have lost.
#if defined(LINETREE_CORE_JET_CORNER_JET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_JET_CORNER_JET_INL_H_
#undef LINETREE_CORE_JET_CORNER_JET_INL_H_
#else
#define LINETREE_CORE_JET_CORNER_JET_INL_H_
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <limits>

#include "core/jet/interval.h"
#include "core/jet/interval_pack-inl.h"

LINETREE_BEFORE_JETS();
namespace linetree::LINETREE_JETS {

// A sum or product of at most sixteen rounded terms, none negative, as an upper bound.
inline double Above(double x) { return x * (1 + 16 * kOutward); }

// What one more rounded operation costs the corner values of a result in `range`.
inline double RoundingOf(const Interval& range, double slack) {
  return (range.Magnitude() + slack) * kOutward + std::numeric_limits<double>::denorm_min();
}

template <size_t Dimension>
struct LooseJet {
  static constexpr size_t D = Dimension;
  static constexpr size_t kCorners = size_t{1} << D;
  using Corners = Pack<kCorners>;

  Interval v;
  IntervalPack<2 * D> ds;  // d, then s
  Corners k;
  double slack = 0;

  IntervalPack<D> d() const { return LowerHalf(ds); }
  IntervalPack<D> s() const { return UpperHalf(ds); }

  double lo() const { return v.lo; }
  double hi() const { return v.hi; }
  double Middle() const { return (v.lo + v.hi) / 2; }
  // Bounds on the excess of f over Q and of Q over f, without slack: sum U and sum L.
  double ExcessOverQ() const { return Above(SumOfLanes(CurvatureDown(s())) / 8); }
  double ExcessUnderQ() const { return Above(SumOfLanes(CurvatureUp(s())) / 8); }
  // |Q - f|, Q made of the corner values held here.
  double InterpolationError() const {
    return RoundUp(Above(SumOfLanes(Magnitudes(s())) / 8) + slack);
  }
  // Sum of sup |df/du_i|: how far f can be from one end of the cell to the other.
  double Variation() const { return Above(SumOfLanes(Magnitudes(d()))); }

 protected:
  static Pack<D> CurvatureDown(const IntervalPack<D>& s) { return Max(Pack<D>::All(0), -s.lo); }
  static Pack<D> CurvatureUp(const IntervalPack<D>& s) { return Max(Pack<D>::All(0), s.hi); }
};

template <size_t Dimension>
struct CornerJet : LooseJet<Dimension> {
  using Loose = LooseJet<Dimension>;
  using Loose::D, Loose::kCorners, Loose::v, Loose::ds, Loose::k, Loose::slack;
  using typename Loose::Corners;

  CornerJet() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): that is how sums are tightened.
  CornerJet(const Loose& loose) : Loose(loose) { Tighten(); }

  static CornerJet Constant(double c) {
    CornerJet jet;
    jet.v = {c, c};
    jet.ds = IntervalPack<2 * D>::All({0, 0});
    jet.k = Corners::All(c);
    return jet;
  }
  // constant + sum by[i] x_i, where x_i runs from from[i] to to[i] along axis i.
  static CornerJet Affine(double constant, const std::array<double, D>& by,
                          const std::array<double, D>& from, const std::array<double, D>& to) {
    double corners[kCorners], lo[2 * D] = {}, hi[2 * D] = {};
    double size = std::abs(constant);
    corners[0] = constant;
    for (size_t i = 0; i < D; ++i) corners[0] += by[i] * from[i];
    for (size_t i = 0; i < D; ++i) {
      const size_t count = size_t{1} << i;
      const double step = by[i] * (to[i] - from[i]);
      for (size_t m = 0; m < count; ++m) corners[m + count] = corners[m] + step;
      const Interval slope = Outward(to[i] - from[i], to[i] - from[i]) * by[i];
      lo[i] = slope.lo;
      hi[i] = slope.hi;
      size += std::abs(by[i]) * (std::abs(from[i]) + std::abs(to[i]));
    }
    CornerJet jet;
    jet.k = Corners::Load(corners);
    jet.ds = {Pack<2 * D>::Load(lo), Pack<2 * D>::Load(hi)};
    // A corner is the sum of 2 D + 1 terms, each of them two or three operations.
    constexpr double kOperations = 2 * D + 3;
    jet.slack = Above(kOperations * (size * kOutward + std::numeric_limits<double>::denorm_min()));
    jet.v = Outward(SmallestLane(jet.k) - jet.slack, LargestLane(jet.k) + jet.slack);
    return jet;
  }
  // The coordinate that runs from `from` to `to` along one axis.
  static CornerJet Variable(size_t axis, double from, double to) {
    std::array<double, D> by{}, begin{}, end{};
    by[axis] = 1;
    begin[axis] = from;
    end[axis] = to;
    return Affine(0, by, begin, end);
  }

  // f is off by up to `error` from what the jet says so far.
  void Widen(double error) {
    slack = Above(slack + error);
    v = Outward(v.lo - error, v.hi + error);
  }
  // Something else is known of f's range.
  void AssumeWithin(double least, double most) {
    v = {std::clamp(v.lo, least, most), std::clamp(v.hi, least, most)};
  }
  // Something else is known of its first and pure second derivatives.
  void AssumeDerivatives(const IntervalPack<D>& first, const IntervalPack<D>& second) {
    ds = Meet(ds, Combine(first, second));
    Tighten();
  }
  // f is known to be concave along every axis.
  void AssumeConcave() {
    IntervalPack<D> s = this->s();
    s.hi = Min(s.hi, Pack<D>::All(0));
    s.lo = Min(s.lo, s.hi);
    ds = Combine(this->d(), s);
    Tighten();
  }

 private:
  void Tighten() {
    const IntervalPack<D> s = this->s();
    const Pack<D> up = this->CurvatureDown(s), down = this->CurvatureUp(s);
    const double sum_up = Above(SumOfLanes(up) * 0.125);
    const double sum_down = Above(SumOfLanes(down) * 0.125);
    const double least = SmallestLane(k), most = LargestLane(k);
    v = Meet(v, Outward(RoundDown(least - sum_down) - slack, RoundUp(most + sum_up) + slack));
    // sum_{j != i} (U_j + L_j) + |s_i|/2 + what the slopes themselves have lost.
    const double total = sum_up + sum_down;
    const Pack<D> others = Pack<D>::All(Above(total)) - (up + down) * Pack<D>::All(0.125);
    const double lost = 2 * slack + 8 * kOutward * (v.Magnitude() + slack);
    const Pack<D> wide = Max(Pack<D>::All(0), others) + Max(up, down) * Pack<D>::All(0.5) +
                         Pack<D>::All(Above(lost + total * 4 * kOutward));
    const LaneSlopes<D> slopes = SlopesOf<D>(k);
    ds = Combine(Meet(this->d(), Outward(slopes.least - wide, slopes.most + wide)), s);
  }
};

// Negated, scaled or moved, a jet is as tight as it was.
template <class J>
concept AnyJet = std::derived_from<J, LooseJet<J::D>>;

template <AnyJet J>
J operator-(const J& a) {
  J r;
  r.v = -a.v;
  r.ds = -a.ds;
  r.k = -a.k;
  r.slack = a.slack;
  return r;
}
template <AnyJet J>
J operator+(const J& a, double c) {
  J r = a;
  r.v = a.v + c;
  r.k = a.k + J::Corners::All(c);
  r.slack = Above(a.slack + RoundingOf(r.v, a.slack));
  return r;
}
template <AnyJet J>
J operator*(const J& a, double c) {
  J r;
  r.v = a.v * c;
  r.ds = a.ds * c;
  r.k = a.k * J::Corners::All(c);
  r.slack = Above(a.slack * std::abs(c));
  r.slack = Above(r.slack + RoundingOf(r.v, r.slack));
  return r;
}

template <size_t D>
LooseJet<D> operator+(const LooseJet<D>& a, const LooseJet<D>& b) {
  LooseJet<D> r;
  r.v = a.v + b.v;
  r.ds = a.ds + b.ds;
  r.k = a.k + b.k;
  r.slack = Above(a.slack + b.slack);
  r.slack = Above(r.slack + RoundingOf(r.v, r.slack));
  return r;
}
template <size_t D>
LooseJet<D> operator-(const LooseJet<D>& a, const LooseJet<D>& b) {
  return a + -b;
}
// (ab)'' = a b'' + b a'' + 2 a' b'.
template <size_t D>
LooseJet<D> operator*(const CornerJet<D>& a, const CornerJet<D>& b) {
  using Terms = IntervalPack<2 * D>;
  LooseJet<D> r;
  r.v = a.v * b.v;
  const IntervalPack<D> both = NearProduct(a.d(), b.d());
  const IntervalPack<D> twice = {both.lo + both.lo, both.hi + both.hi};
  r.ds = SumOfNear(NearProduct(Terms::All(a.v), b.ds), NearProduct(Terms::All(b.v), a.ds),
                   Combine(IntervalPack<D>::All({0, 0}), twice));
  r.k = a.k * b.k;
  r.slack = Above(a.v.Magnitude() * b.slack + b.v.Magnitude() * a.slack + a.slack * b.slack);
  r.slack = Above(r.slack + RoundingOf(r.v, r.slack));
  return r;
}

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
