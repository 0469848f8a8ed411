// x^m in float.
#if defined(LINETREE_CORE_PACKET_POWER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_PACKET_POWER_INL_H_
#undef LINETREE_CORE_PACKET_POWER_INL_H_
#else
#define LINETREE_CORE_PACKET_POWER_INL_H_
#endif

#include "core/packet/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

// log2 of a normal number. Its error is below 4 u |log2 x| + u |e|, with e the whole number nearest
// to it, u = 2^-24: with x = 2^e y, sqrt(1/2) <= y < sqrt(2), and z = (y - 1) / (y + 1),
// log2 y = 2 / ln 2 (z + z^3 / 3 + ... + z^9 / 9), where |z| < 0.1716 and what follows is below
// 2^-26 of z.
HWY_INLINE Floats Log2(const Floats& x) {
  const Ints::Tag ti;
  const Floats::Tag tf;
  Floats exponent, part;
  for (size_t i = 0; i < LanesOf<float>::kVectors; ++i) {
    // Counted from sqrt(1/2), so that the part comes out around 1.
    const auto bits = hn::BitCast(ti, x.v[i]);
    const auto origin = hn::Set(ti, 0x3f3504f3);
    const auto whole = hn::ShiftRight<23>(hn::Sub(bits, origin));
    exponent.v[i] = hn::ConvertTo(tf, whole);
    part.v[i] = hn::BitCast(tf, hn::Sub(bits, hn::ShiftLeft<23>(whole)));
  }
  const Floats one = Floats::All(1);
  const Floats z = (part - one) / (part + one), zz = z * z;
  Floats sum = Floats::All(1.0f / 9);
  for (const float divisor : {7.0f, 5.0f, 3.0f}) {
    sum = MulAdd(sum, zz, Floats::All(1 / divisor));
  }
  sum = MulAdd(sum * zz, z, z);
  return MulAdd(sum, Floats::All(2.8853900817779268f), exponent);
}

// 2^y for y in [-126, 126]; what lies beyond counts as the nearest end. The relative error is below
// 4 u: with y = e + f, |f| <= 1/2, the series of e^(f ln 2) up to the seventh power lacks 2^-27.
HWY_INLINE Floats Exp2(const Floats& y) {
  const Floats clamped = Min(Max(y, Floats::All(-126)), Floats::All(126));
  const Floats whole = Round(clamped);
  const Floats f = (clamped - whole) * Floats::All(0.6931471805599453f);
  Floats sum = Floats::All(1.0f / 5040);
  for (const float factorial : {720.0f, 120.0f, 24.0f, 6.0f, 2.0f, 1.0f, 1.0f}) {
    sum = MulAdd(sum, f, Floats::All(1 / factorial));
  }
  Floats r;
  for (size_t i = 0; i < LanesOf<float>::kVectors; ++i) {
    const auto shifted = hn::ShiftLeft<23>(hn::ConvertTo(Ints::Tag(), whole.v[i]));
    r.v[i] = hn::BitCast(Floats::Tag(), hn::Add(hn::BitCast(Ints::Tag(), sum.v[i]), shifted));
  }
  return r;
}

// x > 0. Relative error: 4 u + |m log2 x| 6 u.
HWY_INLINE Floats Power(const Floats& x, const Floats& m) { return Exp2(m * Log2(x)); }

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
