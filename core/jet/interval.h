// Closed intervals with outward rounding: every operation encloses what it would be in real
// arithmetic. No rounding modes are switched; a bound that comes from a rounded operation is moved
// outwards by at least one unit in the last place (Moore, "Interval Analysis", 1966, chapter 3).
//
// Bounds must stay finite (below 1e150 in size): callers keep to scenes where they do.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace linetree {

// Relative size of one step outwards: at least the distance to the neighbouring double.
inline constexpr double kOutward = 0x1p-52;

inline double RoundUp(double x) {
  return x + (std::abs(x) * kOutward + std::numeric_limits<double>::denorm_min());
}
inline double RoundDown(double x) {
  return x - (std::abs(x) * kOutward + std::numeric_limits<double>::denorm_min());
}

struct Interval {
  double lo = 0, hi = 0;

  bool Contains(double x) const { return lo <= x && x <= hi; }
  // sup |x|.
  double Magnitude() const { return std::max(std::abs(lo), std::abs(hi)); }
  double Width() const { return RoundUp(hi - lo); }
};

// As wide as two bounds that a rounded operation gave.
inline Interval Outward(double lo, double hi) { return {RoundDown(lo), RoundUp(hi)}; }

inline Interval operator-(const Interval& a) { return {-a.hi, -a.lo}; }
inline Interval operator+(const Interval& a, const Interval& b) {
  return Outward(a.lo + b.lo, a.hi + b.hi);
}
inline Interval operator-(const Interval& a, const Interval& b) { return a + -b; }
inline Interval operator*(const Interval& a, const Interval& b) {
  const double p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
  return Outward(std::min(std::min(p, q), std::min(r, s)),
                 std::max(std::max(p, q), std::max(r, s)));
}
inline Interval operator*(const Interval& a, double k) { return a * Interval{k, k}; }
inline Interval operator+(const Interval& a, double k) { return a + Interval{k, k}; }

inline Interval Square(const Interval& a) {
  const double p = a.lo * a.lo, q = a.hi * a.hi;
  if (a.lo >= 0) return {std::max(0.0, RoundDown(p)), RoundUp(q)};
  if (a.hi <= 0) return {std::max(0.0, RoundDown(q)), RoundUp(p)};
  return {0, RoundUp(std::max(p, q))};
}
// 1 / x for an interval that keeps off 0.
inline Interval Inverse(const Interval& a) { return Outward(1 / a.hi, 1 / a.lo); }
// For lo >= 0.
inline Interval SquareRoot(const Interval& a) {
  return {std::max(0.0, RoundDown(std::sqrt(a.lo))), RoundUp(std::sqrt(a.hi))};
}

// pow of the C library is within a unit in the last place; this is eight.
inline constexpr double kPowerRounding = 0x1p-49;

// x^p for 0 <= lo, any real p; lo > 0 where p < 0.
inline Interval Power(const Interval& a, double p) {
  const double at_lo = std::pow(a.lo, p), at_hi = std::pow(a.hi, p);
  const double least = std::min(at_lo, at_hi), most = std::max(at_lo, at_hi);
  return {std::max(0.0, RoundDown(least * (1 - kPowerRounding))),
          RoundUp(most * (1 + kPowerRounding))};
}

// Of two enclosures of the same thing. They meet; should rounding have parted them, what lies
// between is kept.
inline Interval Meet(const Interval& a, const Interval& b) {
  const double lo = std::max(a.lo, b.lo), hi = std::min(a.hi, b.hi);
  return {std::min(lo, hi), std::max(lo, hi)};
}

}  // namespace linetree
