// Fixed numbers of doubles that are worked on together: the lanes of corner jets. Scalar twin.
//
// Code on packs is compiled once for every instruction set: files named -inl.h may be included
// several times, and all they define lives in LINETREE_JETS, a namespace of the instruction set.
#if !defined(LINETREE_JETS)
#define LINETREE_JETS scalar_jets
#endif

#ifndef LINETREE_CORE_JET_PACK_INL_H_
#define LINETREE_CORE_JET_PACK_INL_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/jet/interval.h"

namespace linetree::LINETREE_JETS {

template <size_t N>
struct Pack {
  std::array<double, N> x;

  static Pack All(double value) {
    Pack p;
    p.x.fill(value);
    return p;
  }
  static Pack Load(const double* from) {
    Pack p;
    std::copy(from, from + N, p.x.begin());
    return p;
  }
  void Store(double* to) const { std::copy(x.begin(), x.end(), to); }
};

template <size_t N, class Fn>
Pack<N> MapLanes(const Pack<N>& a, const Pack<N>& b, Fn&& fn) {
  Pack<N> r;
  for (size_t i = 0; i < N; ++i) r.x[i] = fn(a.x[i], b.x[i]);
  return r;
}

template <size_t N>
Pack<N> operator+(const Pack<N>& a, const Pack<N>& b) {
  return MapLanes(a, b, [](double p, double q) { return p + q; });
}
template <size_t N>
Pack<N> operator-(const Pack<N>& a, const Pack<N>& b) {
  return MapLanes(a, b, [](double p, double q) { return p - q; });
}
template <size_t N>
Pack<N> operator*(const Pack<N>& a, const Pack<N>& b) {
  return MapLanes(a, b, [](double p, double q) { return p * q; });
}
template <size_t N>
Pack<N> operator/(const Pack<N>& a, const Pack<N>& b) {
  return MapLanes(a, b, [](double p, double q) { return p / q; });
}
template <size_t N>
Pack<N> operator-(const Pack<N>& a) {
  return MapLanes(a, a, [](double p, double) { return -p; });
}
template <size_t N>
Pack<N> Min(const Pack<N>& a, const Pack<N>& b) {
  return MapLanes(a, b, [](double p, double q) { return p < q ? p : q; });
}
template <size_t N>
Pack<N> Max(const Pack<N>& a, const Pack<N>& b) {
  return MapLanes(a, b, [](double p, double q) { return p > q ? p : q; });
}
template <size_t N>
Pack<N> Abs(const Pack<N>& a) {
  return MapLanes(a, a, [](double p, double) { return std::abs(p); });
}
template <size_t N>
Pack<N> SquareRoot(const Pack<N>& a) {
  return MapLanes(a, a, [](double p, double) { return std::sqrt(p); });
}
template <size_t N>
double SmallestLane(const Pack<N>& a) {
  double least = a.x[0];
  for (size_t i = 1; i < N; ++i) least = a.x[i] < least ? a.x[i] : least;
  return least;
}
template <size_t N>
double LargestLane(const Pack<N>& a) {
  double most = a.x[0];
  for (size_t i = 1; i < N; ++i) most = a.x[i] > most ? a.x[i] : most;
  return most;
}
// Lane m holds a[m with bit Axis set] - a[m with bit Axis clear].
template <size_t Axis, size_t N>
Pack<N> Slopes(const Pack<N>& a) {
  constexpr size_t kBit = size_t{1} << Axis;
  Pack<N> r;
  for (size_t m = 0; m < N; ++m) r.x[m] = a.x[m | kBit] - a.x[m & ~kBit];
  return r;
}

}  // namespace linetree::LINETREE_JETS

#endif
