// What distance leaves of a lamp's light, in jets.
#if defined(LINETREE_CORE_CERTIFY_FADING_JET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_CERTIFY_FADING_JET_INL_H_
#undef LINETREE_CORE_CERTIFY_FADING_JET_INL_H_
#else
#define LINETREE_CORE_CERTIFY_FADING_JET_INL_H_
#endif

#include <cmath>

#include "core/jet/jet_functions-inl.h"
#include "core/scene/light.h"

LINETREE_BEFORE_JETS();
namespace linetree::LINETREE_JETS {

// Beyond, the powers in the derivatives would overflow.
inline constexpr double kMostFading = 1e30;

// FallOff at the distance whose square is given, which is positive; false where there is no bound.
// The lamp fades.
template <size_t D>
bool FadeOver(const Light& light, const CornerJet<D>& square, CornerJet<D>& strength) {
  using Jet = CornerJet<D>;
  const Jet ratio = square * (1 / (light.fade_distance * light.fade_distance));
  const double power = light.fade_power / 2;
  if (!(std::pow(ratio.hi(), power) < kMostFading)) return false;
  strength = Inverse(Jet(Power(ratio, power) + 1.0)) * 2.0;
  return true;
}

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
