// Packs on the vectors of one of Highway's targets. Contracts: scalar_pack-inl.h. Included
// by pack-inl.h.
#if defined(LINETREE_CORE_JET_SIMD_PACK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_JET_SIMD_PACK_INL_H_
#undef LINETREE_CORE_JET_SIMD_PACK_INL_H_
#else
#define LINETREE_CORE_JET_SIMD_PACK_INL_H_
#endif

#include <cstddef>

#include "hwy/highway.h"

LINETREE_BEFORE_JETS();
namespace linetree::LINETREE_JETS {

namespace hn = hwy::HWY_NAMESPACE;

template <size_t N>
struct Pack {
  using Tag = hn::CappedTag<double, N>;
  using Vector = hn::Vec<Tag>;
  static constexpr size_t kLanes = HWY_MIN(N, HWY_LANES(double));
  static constexpr size_t kVectors = N / kLanes;

  Vector v[kVectors];

  static Pack All(double value) {
    Pack p;
    for (Vector& v : p.v) v = hn::Set(Tag(), value);
    return p;
  }
  static Pack Load(const double* from) {
    Pack p;
    for (size_t i = 0; i < kVectors; ++i) p.v[i] = hn::LoadU(Tag(), from + i * kLanes);
    return p;
  }
  void Store(double* to) const {
    for (size_t i = 0; i < kVectors; ++i) hn::StoreU(v[i], Tag(), to + i * kLanes);
  }
};

template <size_t N>
Pack<N> operator+(const Pack<N>& a, const Pack<N>& b) {
  Pack<N> r;
  for (size_t i = 0; i < Pack<N>::kVectors; ++i) r.v[i] = hn::Add(a.v[i], b.v[i]);
  return r;
}
template <size_t N>
Pack<N> operator-(const Pack<N>& a, const Pack<N>& b) {
  Pack<N> r;
  for (size_t i = 0; i < Pack<N>::kVectors; ++i) r.v[i] = hn::Sub(a.v[i], b.v[i]);
  return r;
}
template <size_t N>
Pack<N> operator*(const Pack<N>& a, const Pack<N>& b) {
  Pack<N> r;
  for (size_t i = 0; i < Pack<N>::kVectors; ++i) r.v[i] = hn::Mul(a.v[i], b.v[i]);
  return r;
}
template <size_t N>
Pack<N> operator/(const Pack<N>& a, const Pack<N>& b) {
  Pack<N> r;
  for (size_t i = 0; i < Pack<N>::kVectors; ++i) r.v[i] = hn::Div(a.v[i], b.v[i]);
  return r;
}
template <size_t N>
Pack<N> operator-(const Pack<N>& a) {
  Pack<N> r;
  for (size_t i = 0; i < Pack<N>::kVectors; ++i) r.v[i] = hn::Neg(a.v[i]);
  return r;
}
template <size_t N>
Pack<N> Min(const Pack<N>& a, const Pack<N>& b) {
  Pack<N> r;
  for (size_t i = 0; i < Pack<N>::kVectors; ++i) r.v[i] = hn::Min(a.v[i], b.v[i]);
  return r;
}
template <size_t N>
Pack<N> Max(const Pack<N>& a, const Pack<N>& b) {
  Pack<N> r;
  for (size_t i = 0; i < Pack<N>::kVectors; ++i) r.v[i] = hn::Max(a.v[i], b.v[i]);
  return r;
}
template <size_t N>
Pack<N> Abs(const Pack<N>& a) {
  Pack<N> r;
  for (size_t i = 0; i < Pack<N>::kVectors; ++i) r.v[i] = hn::Abs(a.v[i]);
  return r;
}
template <size_t N>
Pack<N> SquareRoot(const Pack<N>& a) {
  Pack<N> r;
  for (size_t i = 0; i < Pack<N>::kVectors; ++i) r.v[i] = hn::Sqrt(a.v[i]);
  return r;
}

template <size_t N>
Pack<N / 2> LowerHalf(const Pack<N>& a) {
  Pack<N / 2> r;
  if constexpr (Pack<N>::kVectors == 1) {
    r.v[0] = hn::LowerHalf(typename Pack<N / 2>::Tag(), a.v[0]);
  } else {
    for (size_t i = 0; i < Pack<N / 2>::kVectors; ++i) r.v[i] = a.v[i];
  }
  return r;
}
template <size_t N>
Pack<N / 2> UpperHalf(const Pack<N>& a) {
  Pack<N / 2> r;
  if constexpr (Pack<N>::kVectors == 1) {
    r.v[0] = hn::UpperHalf(typename Pack<N / 2>::Tag(), a.v[0]);
  } else {
    for (size_t i = 0; i < Pack<N / 2>::kVectors; ++i) r.v[i] = a.v[i + Pack<N / 2>::kVectors];
  }
  return r;
}

template <size_t N>
Pack<2 * N> Combine(const Pack<N>& lower, const Pack<N>& upper) {
  Pack<2 * N> r;
  if constexpr (Pack<2 * N>::kVectors == 1) {
    r.v[0] = hn::Combine(typename Pack<2 * N>::Tag(), upper.v[0], lower.v[0]);
  } else {
    for (size_t i = 0; i < Pack<N>::kVectors; ++i) {
      r.v[i] = lower.v[i];
      r.v[i + Pack<N>::kVectors] = upper.v[i];
    }
  }
  return r;
}

template <size_t N>
double SmallestLane(const Pack<N>& a) {
  if constexpr (N == 1) {
    return hn::GetLane(a.v[0]);
  } else {
    return SmallestLane(Min(LowerHalf(a), UpperHalf(a)));
  }
}
template <size_t N>
double LargestLane(const Pack<N>& a) {
  if constexpr (N == 1) {
    return hn::GetLane(a.v[0]);
  } else {
    return LargestLane(Max(LowerHalf(a), UpperHalf(a)));
  }
}
template <size_t N>
double SumOfLanes(const Pack<N>& a) {
  if constexpr (N == 1) {
    return hn::GetLane(a.v[0]);
  } else {
    return SumOfLanes(LowerHalf(a) + UpperHalf(a));
  }
}

// Two packs of a and b's lanes that hold, at like places, lanes whose numbers differ in one bit,
// worth `Stride`: clear in the one pack, set in the other. Which lane is where is not said.
template <size_t N>
struct Parted {
  Pack<N> clear, set;
};
template <size_t Stride, size_t N>
Parted<N> Part(const Pack<N>& a, const Pack<N>& b) {
  using P = Pack<N>;
  const typename P::Tag tag;
  Parted<N> r;
  for (size_t i = 0; i < P::kVectors; ++i) {
    if constexpr (Stride == 1) {
      r.clear.v[i] = hn::InterleaveLower(tag, a.v[i], b.v[i]);
      r.set.v[i] = hn::InterleaveUpper(tag, a.v[i], b.v[i]);
    } else if constexpr (Stride == P::kLanes / 2) {
      r.clear.v[i] = hn::ConcatLowerLower(tag, b.v[i], a.v[i]);
      r.set.v[i] = hn::ConcatUpperUpper(tag, b.v[i], a.v[i]);
    } else {
      static_assert(Stride == 2 && P::kLanes == 8);
      r.clear.v[i] = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(b.v[i]), a.v[i]);
      r.set.v[i] = hn::OddEvenBlocks(b.v[i], hn::SwapAdjacentBlocks(a.v[i]));
    }
  }
  return r;
}

// All slopes along one axis, in any order.
template <size_t Axis, size_t N>
Pack<N / 2> Slopes(const Pack<N>& corners) {
  constexpr size_t kStride = size_t{1} << Axis;
  using Half = Pack<N / 2>;
  const Half low = LowerHalf(corners), high = UpperHalf(corners);
  if constexpr (kStride == N / 2) {
    return high - low;
  } else if constexpr (kStride < Half::kLanes) {
    const auto parts = Part<kStride>(low, high);
    return parts.set - parts.clear;
  } else {
    constexpr size_t kStep = kStride / Half::kLanes;
    Half r;
    for (size_t i = 0, at = 0; i < Pack<N>::kVectors; ++i) {
      if ((i & kStep) == 0) r.v[at++] = hn::Sub(corners.v[i + kStep], corners.v[i]);
    }
    return r;
  }
}

template <size_t D>
struct LaneSlopes {
  Pack<D> least, most;
};

// Folds two packs into one that holds in like lanes what is left of a, in others what of b.
template <size_t Stride, size_t D>
LaneSlopes<D> FoldPair(const LaneSlopes<D>& a, const LaneSlopes<D>& b) {
  const auto least = Part<Stride>(a.least, b.least);
  const auto most = Part<Stride>(a.most, b.most);
  return {Min(least.clear, least.set), Max(most.clear, most.set)};
}

// Slopes along one axis, down to D lanes.
template <size_t D, size_t N>
LaneSlopes<D> FoldTo(const Pack<N>& least, const Pack<N>& most) {
  if constexpr (N == D) {
    return {least, most};
  } else {
    return FoldTo<D>(Min(LowerHalf(least), UpperHalf(least)),
                     Max(LowerHalf(most), UpperHalf(most)));
  }
}
template <size_t Axis, size_t D>
LaneSlopes<D> SlopesAlong(const Pack<size_t{1} << D>& corners) {
  const auto slopes = Slopes<Axis>(corners);
  return FoldTo<D>(slopes, slopes);
}

template <size_t D>
LaneSlopes<D> SlopesOf(const Pack<size_t{1} << D>& corners) {
  const auto low = FoldPair<1>(SlopesAlong<0, D>(corners), SlopesAlong<1, D>(corners));
  if constexpr (D == 2) {
    return low;
  } else {
    static_assert(D == 4);
    const auto high = FoldPair<1>(SlopesAlong<2, D>(corners), SlopesAlong<3, D>(corners));
    // Lanes 0 to 3: slopes along axis 0, 1, 0, 1 in `low`, along 2, 3, 2, 3 in `high`.
    if constexpr (Pack<D>::kLanes == 4) {
      return FoldPair<2>(low, high);
    } else {
      LaneSlopes<D> r;
      r.least.v[0] = hn::Min(low.least.v[0], low.least.v[1]);
      r.least.v[1] = hn::Min(high.least.v[0], high.least.v[1]);
      r.most.v[0] = hn::Max(low.most.v[0], low.most.v[1]);
      r.most.v[1] = hn::Max(high.most.v[0], high.most.v[1]);
      return r;
    }
  }
}

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
