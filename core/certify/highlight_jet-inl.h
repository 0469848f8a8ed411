// Highlights in jets: (n.h)^exponent, where h is half way between the light and the way back.
#if defined(LINETREE_CORE_CERTIFY_HIGHLIGHT_JET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_CERTIFY_HIGHLIGHT_JET_INL_H_
#undef LINETREE_CORE_CERTIFY_HIGHLIGHT_JET_INL_H_
#else
#define LINETREE_CORE_CERTIFY_HIGHLIGHT_JET_INL_H_
#endif

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/certify/jet_hit-inl.h"
#include "core/certify/margins-inl.h"

LINETREE_BEFORE_JETS();
namespace linetree::LINETREE_JETS {

// No jet divides by less.
inline constexpr double kLeastDenominator = 0x1p-20;
// Where n.(l + v) is less, light and eye are both near the horizon.
inline constexpr double kLeastElevation = 0x1p-10;

// (1 + |w|^2)^-q, q >= 0, of a vector w: the chain rule, and beside it what follows from how the
// parts belong together. With y = |w|^2 and G(y) = (1 + y)^-q,
//   G_i = 2 G' w.w_i,   G_ii = G' y_ii + 4 G'' (w.w_i)^2,   |w.w_i| <= sqrt(y) |w_i|,
// and sqrt(y) |G'| and y G'' have their only maxima at y = 1 / (2 q + 1) and 1 / (q + 1). The chain
// rule multiplies the largest G'', which is at the peak, by the largest slopes of y, far from it.
template <size_t D>
CornerJet<D> Bell(const JetVector<D>& w, double q) {
  using Lanes = IntervalPack<D>;
  CornerJet<D> y = LengthSquared(w);
  y.AssumeWithin(0, std::numeric_limits<double>::infinity());
  CornerJet<D> bell = Power(CornerJet<D>(y + 1.0), -q);
  // Of 1 + y, q times over, and of a few operations more.
  const double rounding = 1 + (q + 8) * kOutward + kPowerRounding;
  const auto power = [&](double at, double p) { return std::pow(1 + at, -q - p) * rounding; };
  const double steepest = std::clamp(1 / (2 * q + 1), y.lo(), y.hi());
  const double sharpest = std::clamp(1 / (q + 1), y.lo(), y.hi());
  const double slope = 2 * q * std::sqrt(steepest) * power(steepest, 1) * rounding;
  const double bend = 4 * q * (q + 1) * sharpest * power(sharpest, 2) * rounding;
  const Interval first =
      Outward(-q * power(y.lo(), 1) * rounding, -q * power(y.hi(), 1) / (rounding * rounding));
  const Lanes squares = Square(w.x.d()) + Square(w.y.d()) + Square(w.z.d());
  const Lanes longest = Outward(SquareRoot(squares.hi), SquareRoot(squares.hi));
  const Lanes bent = Interval{bend, bend} * squares;
  bell.AssumeDerivatives(Interval{-slope, slope} * Lanes{longest.hi, longest.hi},
                         first * y.s() + Lanes{Pack<D>::All(0), bent.hi});
  return bell;
}

// (n.h)^exponent at hits where `both` is l + v, the unit vectors to the light and back, and
// `cosine` n.l. False where there is no bound. With N = n.(l + v) and w = (l + v) / N - n, which is
// across n,
//   (n.h)^2 = N^2 / |l + v|^2 = 1 / (1 + |w|^2):
// near the peak w is small, and nothing that varies more is subtracted from its like. Where N may
// be small, the quotient is taken as it stands.
template <size_t D>
bool HighlightOf(const JetHit<D>& hit, const JetVector<D>& both, const CornerJet<D>& cosine,
                 double exponent, CornerJet<D>& highlight) {
  using Jet = CornerJet<D>;
  using Vector = JetVector<D>;
  const Jet elevation = cosine + hit.cosine;
  const double power = exponent / 2;
  if (elevation.lo() > kLeastElevation) {
    const Vector along = both * Inverse(elevation);
    highlight = Bell(hit.flat ? along - hit.flat_normal : Vector(along + -hit.normal), power);
    return true;
  }
  Jet denominator = LengthSquared(both);
  denominator.AssumeWithin(0, 4);
  if (!IsPositive(denominator, kLeastDenominator / kSignMargin)) return false;
  const Jet half = Square(elevation);
  Jet square = half * Inverse(denominator);
  square.AssumeWithin(0, 1);
  const bool smooth = power >= 2 || power == 1 || power == 0;
  if (!smooth && !(square.lo() > kLeastDenominator)) return false;
  highlight = Power(square, power);
  return true;
}

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
