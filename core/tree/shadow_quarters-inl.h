// shadow_quarters.h on the vectors of one of Highway's targets. Included by shadow_quarters.cpp.
#if defined(LINETREE_CORE_TREE_SHADOW_QUARTERS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_TREE_SHADOW_QUARTERS_INL_H_
#undef LINETREE_CORE_TREE_SHADOW_QUARTERS_INL_H_
#else
#define LINETREE_CORE_TREE_SHADOW_QUARTERS_INL_H_
#endif

#include "core/tree/shadow_quarters.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using FormTag = hn::CappedTag<double, kQuarterBlock>;
using FormVector = hn::Vec<FormTag>;
using FloatTag = hn::Rebind<float, FormTag>;
using FlagTag = hn::Rebind<uint64_t, FormTag>;
using ByteTag = hn::Rebind<uint8_t, FormTag>;

inline hn::Vec<FlagTag> FlagWhere(hn::Mask<FormTag> mask, uint8_t flag) {
  const FlagTag d;
  return hn::IfThenElseZero(hn::RebindMask(d, mask), hn::Set(d, flag));
}
// What the least and the largest value say.
inline hn::Vec<FlagTag> FlagsOf(const FormVector low, const FormVector high) {
  const FormTag d;
  const auto misses = hn::Gt(low, hn::Set(d, 1));
  const auto needed = hn::Not(hn::Lt(high, hn::Set(d, -1)));
  return hn::Or(FlagWhere(misses, QuarteredLines::kMisses),
                FlagWhere(needed, QuarteredLines::kNeeded));
}

inline hn::Vec<FlagTag> KeepsAt(const FormVector value, uint8_t flag) {
  return FlagWhere(hn::Le(value, hn::Set(FormTag(), kCut)), flag);
}

// A vector of forms, as QuarterLinesScalar does one.
inline void QuarterVector(const float* lines, double i, double j, float* cs, float* ss, float* ts,
                          uint8_t* flags) {
  const FormTag d;
  const FloatTag floats;
  hn::Vec<FloatTag> c, s, t;
  hn::LoadInterleaved3(floats, lines, c, s, t);
  const auto half = hn::Set(d, 0.5), zero = hn::Zero(d);
  const auto along_s = hn::Mul(hn::PromoteTo(d, s), half);
  const auto along_t = hn::Mul(hn::PromoteTo(d, t), half);
  const auto at = hn::Add(hn::Add(hn::PromoteTo(d, c), hn::Mul(along_s, hn::Set(d, i))),
                          hn::Mul(along_t, hn::Set(d, j)));
  const auto low = hn::Add(hn::Add(at, hn::Min(along_s, zero)), hn::Min(along_t, zero));
  const auto high = hn::Add(hn::Add(at, hn::Max(along_s, zero)), hn::Max(along_t, zero));
  c = hn::DemoteTo(floats, at);
  s = hn::DemoteTo(floats, along_s);
  t = hn::DemoteTo(floats, along_t);
  hn::StoreU(c, floats, cs);
  hn::StoreU(s, floats, ss);
  hn::StoreU(t, floats, ts);
  const auto x00 = hn::PromoteTo(d, c), ds = hn::PromoteTo(d, s), dt = hn::PromoteTo(d, t);
  const auto x10 = hn::Add(x00, ds);
  const auto known = hn::Or(FlagsOf(low, high), KeepsAt(x00, QuarteredLines::kKeeps00));
  const auto sides = hn::Or(KeepsAt(x10, QuarteredLines::kKeeps10),
                            KeepsAt(hn::Add(x00, dt), QuarteredLines::kKeeps01));
  const auto middle = hn::Add(hn::Add(x00, hn::Mul(ds, half)), hn::Mul(dt, half));
  const auto others = hn::Or(KeepsAt(hn::Add(x10, dt), QuarteredLines::kKeeps11),
                             KeepsAt(middle, QuarteredLines::kKeepsMiddle));
  hn::StoreU(hn::TruncateTo(ByteTag(), hn::Or(hn::Or(known, sides), others)), ByteTag(), flags);
}

inline void QuarterLines(const float* lines, size_t count, int child, QuarteredLines& quartered) {
  const size_t lanes = hn::Lanes(FormTag());
  const double i = child & 1, j = child >> 1 & 1;
  const auto quarter = [&](const float* from, size_t at) {
    QuarterVector(from, i, j, &quartered.c[at], &quartered.s[at], &quartered.t[at],
                  &quartered.flags[at]);
  };
  size_t at = 0;
  for (; at + lanes <= count; at += lanes) quarter(lines + at * kLinearSize, at);
  if (at == count) return;
  std::array<float, kQuarterBlock * kLinearSize> rest{};
  std::copy(lines + at * kLinearSize, lines + count * kLinearSize, rest.begin());
  quarter(rest.data(), at);
}

// As QuarterSquaresScalar, operation by operation.
inline void QuarterSquares(size_t count, int child, QuarteredSquares& squares) {
  const FormTag d;
  const FloatTag floats;
  const auto i = hn::Set(d, child & 1), j = hn::Set(d, child >> 1 & 1);
  const auto two = hn::Set(d, 2), half = hn::Set(d, 0.5), fourth = hn::Set(d, 0.25);
  const auto halved = [&](const FormVector v) { return hn::Mul(v, half); };
  const auto sum = [](const FormVector a, const FormVector b) { return hn::Add(a, b); };
  for (size_t at = 0; at < count; at += hn::Lanes(d)) {
    const auto load = [&](size_t k) {
      return hn::PromoteTo(d, hn::LoadU(floats, &squares.k[k][at]));
    };
    const auto store = [&](size_t k, const FormVector v) {
      hn::StoreU(hn::DemoteTo(floats, v), floats, &squares.k[k][at]);
    };
    const auto s1 = halved(load(1)), t1 = halved(load(2));
    const auto ss = hn::Mul(load(3), fourth), st = hn::Mul(load(4), fourth),
               tt = hn::Mul(load(5), fourth);
    auto c = sum(sum(load(0), hn::Mul(s1, i)), hn::Mul(t1, j));
    c = sum(sum(sum(c, hn::Mul(ss, i)), hn::Mul(hn::Mul(st, i), j)), hn::Mul(tt, j));
    const auto s = sum(sum(s1, hn::Mul(hn::Mul(two, ss), i)), hn::Mul(st, j));
    const auto t = sum(sum(t1, hn::Mul(st, i)), hn::Mul(hn::Mul(two, tt), j));
    store(0, c);
    store(1, s);
    store(2, t);
    store(3, ss);
    store(4, st);
    store(5, tt);
    const auto right = sum(sum(c, s), ss), top = sum(sum(c, t), tt);
    const auto s2 = halved(s), t2 = halved(t), st2 = halved(st);
    const auto middle = sum(sum(c, halved(sum(s, t))), hn::Mul(st, fourth));
    const auto last = sum(sum(sum(right, t), tt), st);
    const FormVector values[] = {sum(c, s2),
                                 right,
                                 sum(c, t2),
                                 middle,
                                 sum(sum(right, t2), st2),
                                 top,
                                 sum(sum(top, s2), st2),
                                 last};
    auto low = c, high = c;
    for (const FormVector& value : values) {
      low = hn::Min(low, value);
      high = hn::Max(high, value);
    }
    const auto sides =
        hn::Or(KeepsAt(right, QuarteredLines::kKeeps10), KeepsAt(top, QuarteredLines::kKeeps01));
    const auto ends =
        hn::Or(KeepsAt(c, QuarteredLines::kKeeps00), KeepsAt(last, QuarteredLines::kKeeps11));
    const auto flags = hn::Or(FlagsOf(low, high), hn::Or(sides, ends));
    hn::StoreU(hn::TruncateTo(ByteTag(), flags), ByteTag(), &squares.flags[at]);
  }
}

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
