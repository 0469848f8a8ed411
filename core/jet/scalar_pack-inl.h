// Packs without SIMD: what simd_pack-inl.h is held against, and what machines without SSE4 run. The
// contracts are here. Included by pack-inl.h.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace linetree::LINETREE_JETS {

// N is a power of two.
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
Pack<N / 2> LowerHalf(const Pack<N>& a) {
  return Pack<N / 2>::Load(a.x.data());
}
template <size_t N>
Pack<N / 2> UpperHalf(const Pack<N>& a) {
  return Pack<N / 2>::Load(a.x.data() + N / 2);
}
template <size_t N>
Pack<2 * N> Combine(const Pack<N>& lower, const Pack<N>& upper) {
  Pack<2 * N> r;
  std::copy(upper.x.begin(), upper.x.end(), std::copy(lower.x.begin(), lower.x.end(), r.x.begin()));
  return r;
}

template <size_t N>
double SmallestLane(const Pack<N>& a) {
  return *std::min_element(a.x.begin(), a.x.end());
}
template <size_t N>
double LargestLane(const Pack<N>& a) {
  return *std::max_element(a.x.begin(), a.x.end());
}
// In this order: the upper half is added to the lower one until one lane is left.
template <size_t N>
double SumOfLanes(const Pack<N>& a) {
  std::array<double, N> x = a.x;
  for (size_t half = N / 2; half > 0; half /= 2) {
    for (size_t i = 0; i < half; ++i) x[i] += x[i + half];
  }
  return x[0];
}

// Lane m stands for the corner m of a cell: bit i says at which end of axis i.
template <size_t D>
struct LaneSlopes {
  Pack<D> least, most;  // of the differences along axis i, in lane i
};
template <size_t D>
LaneSlopes<D> SlopesOf(const Pack<size_t{1} << D>& corners) {
  LaneSlopes<D> r;
  for (size_t i = 0; i < D; ++i) {
    const size_t end = size_t{1} << i;
    r.least.x[i] = r.most.x[i] = corners.x[end] - corners.x[0];
    for (size_t m = 1; m < size_t{1} << D; ++m) {
      if ((m & end) != 0) continue;
      const double slope = corners.x[m | end] - corners.x[m];
      r.least.x[i] = std::min(r.least.x[i], slope);
      r.most.x[i] = std::max(r.most.x[i], slope);
    }
  }
  return r;
}

}  // namespace linetree::LINETREE_JETS
