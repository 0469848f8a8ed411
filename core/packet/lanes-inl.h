// Sixteen floats, integers, doubles or truth values, on the vectors of one of Highway's targets.
//
// Operations on doubles are single roundings in the order written: where the scalar tracer does the
// same ones, the bits are equal. Those on floats may fuse (MulAdd).
#if defined(LINETREE_CORE_PACKET_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_PACKET_LANES_INL_H_
#undef LINETREE_CORE_PACKET_LANES_INL_H_
#else
#define LINETREE_CORE_PACKET_LANES_INL_H_
#endif

#include <cstddef>
#include <cstring>

#include "core/packet/packet.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class T>
struct LanesOf {
  static constexpr size_t kWidth = HWY_MIN(size_t{kPacketLanes}, HWY_LANES(T));
  static constexpr size_t kVectors = size_t{kPacketLanes} / kWidth;
  using Tag = hn::CappedTag<T, kWidth>;
  using Vector = hn::Vec<Tag>;
};

template <class T>
struct Truth {
  using L = LanesOf<T>;
  hn::Mask<typename L::Tag> v[L::kVectors];
};

template <class T>
struct Lanes {
  using L = LanesOf<T>;
  using Tag = typename L::Tag;
  typename L::Vector v[L::kVectors];

  static HWY_INLINE Lanes All(T value) {
    Lanes r;
    for (auto& v : r.v) v = hn::Set(Tag(), value);
    return r;
  }
  static HWY_INLINE Lanes Load(const T* from) {
    Lanes r;
    for (size_t i = 0; i < L::kVectors; ++i) r.v[i] = hn::Load(Tag(), from + i * L::kWidth);
    return r;
  }
  HWY_INLINE void Store(T* to) const {
    for (size_t i = 0; i < L::kVectors; ++i) hn::Store(v[i], Tag(), to + i * L::kWidth);
  }
};
using Floats = Lanes<float>;
using Ints = Lanes<int32_t>;
using Doubles = Lanes<double>;
using Mask = Truth<float>;
using WideMask = Truth<double>;

#define LINETREE_LANES_BINARY(symbol, name)                                              \
  template <class T>                                                                     \
  HWY_INLINE Lanes<T> operator symbol(const Lanes<T>& a, const Lanes<T>& b) {            \
    Lanes<T> r;                                                                          \
    for (size_t i = 0; i < LanesOf<T>::kVectors; ++i) r.v[i] = hn::name(a.v[i], b.v[i]); \
    return r;                                                                            \
  }
LINETREE_LANES_BINARY(+, Add)
LINETREE_LANES_BINARY(-, Sub)
LINETREE_LANES_BINARY(*, Mul)
LINETREE_LANES_BINARY(/, Div)
LINETREE_LANES_BINARY(&, And)
LINETREE_LANES_BINARY(|, Or)
#undef LINETREE_LANES_BINARY

#define LINETREE_LANES_COMPARE(symbol, name)                                             \
  template <class T>                                                                     \
  HWY_INLINE Truth<T> operator symbol(const Lanes<T>& a, const Lanes<T>& b) {            \
    Truth<T> r;                                                                          \
    for (size_t i = 0; i < LanesOf<T>::kVectors; ++i) r.v[i] = hn::name(a.v[i], b.v[i]); \
    return r;                                                                            \
  }
LINETREE_LANES_COMPARE(<, Lt)
LINETREE_LANES_COMPARE(>, Gt)
LINETREE_LANES_COMPARE(<=, Le)
LINETREE_LANES_COMPARE(>=, Ge)
LINETREE_LANES_COMPARE(==, Eq)
#undef LINETREE_LANES_COMPARE

template <class T>
HWY_INLINE Truth<T> operator&(const Truth<T>& a, const Truth<T>& b) {
  Truth<T> r;
  for (size_t i = 0; i < LanesOf<T>::kVectors; ++i) r.v[i] = hn::And(a.v[i], b.v[i]);
  return r;
}
template <class T>
HWY_INLINE Truth<T> operator|(const Truth<T>& a, const Truth<T>& b) {
  Truth<T> r;
  for (size_t i = 0; i < LanesOf<T>::kVectors; ++i) r.v[i] = hn::Or(a.v[i], b.v[i]);
  return r;
}
// a and not b.
template <class T>
HWY_INLINE Truth<T> Without(const Truth<T>& a, const Truth<T>& b) {
  Truth<T> r;
  for (size_t i = 0; i < LanesOf<T>::kVectors; ++i) r.v[i] = hn::AndNot(b.v[i], a.v[i]);
  return r;
}

// a * b + c and c - a * b.
HWY_INLINE Floats MulAdd(const Floats& a, const Floats& b, const Floats& c) {
  Floats r;
  for (size_t i = 0; i < LanesOf<float>::kVectors; ++i) r.v[i] = hn::MulAdd(a.v[i], b.v[i], c.v[i]);
  return r;
}
HWY_INLINE Floats NegMulAdd(const Floats& a, const Floats& b, const Floats& c) {
  Floats r;
  for (size_t i = 0; i < LanesOf<float>::kVectors; ++i) {
    r.v[i] = hn::NegMulAdd(a.v[i], b.v[i], c.v[i]);
  }
  return r;
}

#define LINETREE_LANES_UNARY(function, name)                                     \
  template <class T>                                                             \
  HWY_INLINE Lanes<T> function(const Lanes<T>& a) {                              \
    Lanes<T> r;                                                                  \
    for (size_t i = 0; i < LanesOf<T>::kVectors; ++i) r.v[i] = hn::name(a.v[i]); \
    return r;                                                                    \
  }
LINETREE_LANES_UNARY(operator-, Neg)
LINETREE_LANES_UNARY(Abs, Abs)
LINETREE_LANES_UNARY(Sqrt, Sqrt)
LINETREE_LANES_UNARY(Round, Round)
#undef LINETREE_LANES_UNARY

// 1 / sqrt(x), off by less than 2^-11 of itself. Only x86 promises that much of its estimates.
HWY_INLINE Floats NearInverseSqrt(const Floats& x) {
  Floats r;
  for (size_t i = 0; i < LanesOf<float>::kVectors; ++i) {
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR
    r.v[i] = hn::ApproximateReciprocalSqrt(x.v[i]);
#else
    r.v[i] = hn::Div(hn::Set(Floats::Tag(), 1.0f), hn::Sqrt(x.v[i]));
#endif
  }
  return r;
}

#define LINETREE_LANES_PAIR(function, name)                                              \
  template <class T>                                                                     \
  HWY_INLINE Lanes<T> function(const Lanes<T>& a, const Lanes<T>& b) {                   \
    Lanes<T> r;                                                                          \
    for (size_t i = 0; i < LanesOf<T>::kVectors; ++i) r.v[i] = hn::name(a.v[i], b.v[i]); \
    return r;                                                                            \
  }
LINETREE_LANES_PAIR(Min, Min)
LINETREE_LANES_PAIR(Max, Max)
LINETREE_LANES_PAIR(CopySign, CopySign)
#undef LINETREE_LANES_PAIR

template <class T>
HWY_INLINE Lanes<T> Select(const Truth<T>& which, const Lanes<T>& yes, const Lanes<T>& no) {
  Lanes<T> r;
  for (size_t i = 0; i < LanesOf<T>::kVectors; ++i) {
    r.v[i] = hn::IfThenElse(which.v[i], yes.v[i], no.v[i]);
  }
  return r;
}
HWY_INLINE Ints Select(const Mask& which, const Ints& yes, const Ints& no) {
  Ints r;
  for (size_t i = 0; i < LanesOf<float>::kVectors; ++i) {
    r.v[i] = hn::IfThenElse(hn::RebindMask(Ints::Tag(), which.v[i]), yes.v[i], no.v[i]);
  }
  return r;
}

// Masks of floats and of the integers beside them are the same lanes.
HWY_INLINE Mask OfFloats(const Truth<int32_t>& a) {
  Mask r;
  for (size_t i = 0; i < LanesOf<float>::kVectors; ++i) {
    r.v[i] = hn::RebindMask(Floats::Tag(), a.v[i]);
  }
  return r;
}

template <class T>
HWY_INLINE LaneMask BitsOf(const Truth<T>& a) {
  using L = LanesOf<T>;
  LaneMask bits = 0;
  for (size_t i = 0; i < L::kVectors; ++i) {
    uint8_t bytes[8] = {};
    hn::StoreMaskBits(typename L::Tag(), a.v[i], bytes);
    LaneMask part;
    std::memcpy(&part, bytes, sizeof(part));
    bits |= (part & ((LaneMask{1} << L::kWidth) - 1)) << (i * L::kWidth);
  }
  return bits;
}
template <class T>
HWY_INLINE Truth<T> TruthOf(LaneMask bits) {
  using L = LanesOf<T>;
  Truth<T> r;
  for (size_t i = 0; i < L::kVectors; ++i) {
    uint8_t bytes[8] = {};
    const LaneMask part = bits >> (i * L::kWidth) & ((LaneMask{1} << L::kWidth) - 1);
    std::memcpy(bytes, &part, sizeof(part));
    r.v[i] = hn::LoadMaskBits(typename L::Tag(), bytes);
  }
  return r;
}
HWY_INLINE Mask MaskOf(LaneMask bits) { return TruthOf<float>(bits); }

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE Floats Demoted(const Doubles& a) {
  Floats r;
  for (size_t i = 0; i < LanesOf<float>::kVectors; ++i) {
    r.v[i] = hn::DemoteTo(Floats::Tag(), a.v[i]);
  }
  return r;
}
#else
HWY_INLINE Floats Demoted(const Doubles& a) {
  const hn::Rebind<float, Doubles::Tag> half;
  Floats r;
  for (size_t i = 0; i < LanesOf<float>::kVectors; ++i) {
    r.v[i] = hn::Combine(Floats::Tag(), hn::DemoteTo(half, a.v[2 * i + 1]),
                         hn::DemoteTo(half, a.v[2 * i]));
  }
  return r;
}
#endif

HWY_INLINE float Smallest(const Floats& a) {
  auto v = a.v[0];
  for (size_t i = 1; i < LanesOf<float>::kVectors; ++i) v = hn::Min(v, a.v[i]);
  return hn::GetLane(hn::MinOfLanes(Floats::Tag(), v));
}
HWY_INLINE float Largest(const Floats& a) {
  auto v = a.v[0];
  for (size_t i = 1; i < LanesOf<float>::kVectors; ++i) v = hn::Max(v, a.v[i]);
  return hn::GetLane(hn::MaxOfLanes(Floats::Tag(), v));
}

HWY_INLINE Floats Gathered(const float* table, const Ints& index) {
  Floats r;
  for (size_t i = 0; i < LanesOf<float>::kVectors; ++i) {
    r.v[i] = hn::GatherIndex(Floats::Tag(), table, index.v[i]);
  }
  return r;
}

template <class T>
struct LaneVector {
  Lanes<T> x, y, z;
};
using Vectors = LaneVector<float>;
using WideVectors = LaneVector<double>;

template <class T>
HWY_INLINE LaneVector<T> operator-(const LaneVector<T>& a, const LaneVector<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
HWY_INLINE LaneVector<T> operator+(const LaneVector<T>& a, const LaneVector<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
HWY_INLINE LaneVector<T> operator*(const LaneVector<T>& a, const Lanes<T>& k) {
  return {a.x * k, a.y * k, a.z * k};
}
template <class T>
HWY_INLINE LaneVector<T> operator-(const LaneVector<T>& a) {
  return {-a.x, -a.y, -a.z};
}
template <class T>
HWY_INLINE LaneVector<T> Select(const Truth<T>& which, const LaneVector<T>& yes,
                                const LaneVector<T>& no) {
  return {Select(which, yes.x, no.x), Select(which, yes.y, no.y), Select(which, yes.z, no.z)};
}
HWY_INLINE Floats Dot(const Vectors& a, const Vectors& b) {
  return MulAdd(a.z, b.z, MulAdd(a.y, b.y, a.x * b.x));
}
// In the order of Dot(Vec3, Vec3).
HWY_INLINE Doubles Dot(const WideVectors& a, const WideVectors& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
HWY_INLINE WideVectors Spread(const Vec3d& v) {
  return {Doubles::All(v.x), Doubles::All(v.y), Doubles::All(v.z)};
}
HWY_INLINE Vectors Spread(const float* v) {
  return {Floats::All(v[0]), Floats::All(v[1]), Floats::All(v[2])};
}
HWY_INLINE WideVectors Load(const PacketVectors& v) {
  return {Doubles::Load(v.x), Doubles::Load(v.y), Doubles::Load(v.z)};
}
HWY_INLINE void Store(const WideVectors& v, PacketVectors& to) {
  v.x.Store(to.x);
  v.y.Store(to.y);
  v.z.Store(to.z);
}
HWY_INLINE Vectors Demoted(const WideVectors& v) {
  return {Demoted(v.x), Demoted(v.y), Demoted(v.z)};
}

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
