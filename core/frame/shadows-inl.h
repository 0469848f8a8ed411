// Shadow functions (core/trace/shadow_function.h), sixteen points at a time.
#if defined(LINETREE_CORE_FRAME_SHADOWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_FRAME_SHADOWS_INL_H_
#undef LINETREE_CORE_FRAME_SHADOWS_INL_H_
#else
#define LINETREE_CORE_FRAME_SHADOWS_INL_H_
#endif

#include <cmath>

#include "core/packet/lanes-inl.h"
#include "core/trace/shadow_function.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

struct LaneShadowing {
  Mask blocks, misses;  // in the other lanes the function does not know
};

// ShadowingAt. A fused product rounds less than what the forms' units allow for.
HWY_INLINE LaneShadowing ShadowingOf(const ShadowFunction& function, const float* coefficients,
                                     const Floats& s, const Floats& t) {
  const float* c = coefficients + function.begin;
  LaneShadowing at = {MaskOf(0), MaskOf(function.pieces > 0 ? kAllLanes : 0)};
  for (size_t piece = 0; piece < function.pieces; ++piece) {
    Floats most = Floats::All(-std::numeric_limits<float>::infinity());
    for (size_t i = 0; i < function.lines[piece]; ++i, c += kLinearSize) {
      most =
          Max(most, MulAdd(Floats::All(c[2]), t, MulAdd(Floats::All(c[1]), s, Floats::All(c[0]))));
    }
    if ((function.squares >> piece & 1) != 0) {
      const Floats by_s =
          MulAdd(Floats::All(c[4]), t, MulAdd(Floats::All(c[3]), s, Floats::All(c[1])));
      const Floats by_t = MulAdd(Floats::All(c[5]), t, Floats::All(c[2]));
      most = Max(most, MulAdd(by_t, t, MulAdd(by_s, s, Floats::All(c[0]))));
      c += kQuadraticSize;
    }
    at.blocks = at.blocks | (most < Floats::All(-1));
    at.misses = at.misses & (most > Floats::All(1));
  }
  return at;
}

// The same where it holds for all points that are no farther than ds and dt from these, along s and
// t. Forms change by their gradient there times the way, and by their second-order terms; what that
// rounds to is less than kFootRounding of their units.
HWY_INLINE LaneShadowing ShadowingAround(const ShadowFunction& function, const float* coefficients,
                                         const Floats& s, const Floats& t, float ds, float dt) {
  constexpr float kFootRounding = 0x1p-10f;
  const float* c = coefficients + function.begin;
  LaneShadowing at = {MaskOf(0), MaskOf(function.pieces > 0 ? kAllLanes : 0)};
  for (size_t piece = 0; piece < function.pieces; ++piece) {
    Floats high = Floats::All(-std::numeric_limits<float>::infinity()), low = high;
    for (size_t i = 0; i < function.lines[piece]; ++i, c += kLinearSize) {
      const Floats value =
          MulAdd(Floats::All(c[2]), t, MulAdd(Floats::All(c[1]), s, Floats::All(c[0])));
      const Floats change = Floats::All((std::abs(c[1]) * ds + std::abs(c[2]) * dt) * 1.0001f);
      high = Max(high, value + change);
      low = Max(low, value - change);
    }
    if ((function.squares >> piece & 1) != 0) {
      const Floats by_s =
          MulAdd(Floats::All(c[4]), t, MulAdd(Floats::All(c[3]), s, Floats::All(c[1])));
      const Floats by_t = MulAdd(Floats::All(c[5]), t, Floats::All(c[2]));
      const Floats value = MulAdd(by_t, t, MulAdd(by_s, s, Floats::All(c[0])));
      const Floats slope_s = MulAdd(Floats::All(c[3]), s, by_s);
      const Floats slope_t = MulAdd(Floats::All(c[4]), s, MulAdd(Floats::All(c[5]), t, by_t));
      const float second =
          std::abs(c[3]) * ds * ds + std::abs(c[4]) * ds * dt + std::abs(c[5]) * dt * dt;
      const Floats change = MulAdd(Abs(slope_s), Floats::All(ds),
                                   MulAdd(Abs(slope_t), Floats::All(dt), Floats::All(second))) *
                            Floats::All(1.0001f);
      high = Max(high, value + change);
      low = Max(low, value - change);
      c += kQuadraticSize;
    }
    at.blocks = at.blocks | (high < Floats::All(-1 - kFootRounding));
    at.misses = at.misses & (low > Floats::All(1 + kFootRounding));
  }
  return at;
}

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
