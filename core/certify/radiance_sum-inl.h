// The radiance of a cell's rays as a sum of terms: corner values, a lower bound, and a bound on the
// error of interpolating it.
#if defined(LINETREE_CORE_CERTIFY_RADIANCE_SUM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_CERTIFY_RADIANCE_SUM_INL_H_
#undef LINETREE_CORE_CERTIFY_RADIANCE_SUM_INL_H_
#else
#define LINETREE_CORE_CERTIFY_RADIANCE_SUM_INL_H_
#endif

#include "core/jet/corner_jet-inl.h"
#include "core/math/rgb.h"
#include "core/tree/interpolant.h"

LINETREE_BEFORE_JETS();
namespace linetree::LINETREE_JETS {

template <size_t D>
class RadianceSum {
 public:
  using Jet = CornerJet<D>;
  static constexpr size_t kCorners = Jet::kCorners;

  RadianceSum() {
    for (Channel& c : channels_) {
      c.corners = Pack<kCorners>::All(0);
      c.curvature = IntervalPack<D>::All({0, 0});
    }
  }

  // A term of every ray: colour * f. Neither is negative. The interpolant of f's corners may exceed
  // f by `excess` more than the jet says.
  void Add(const Rgb& colour, Jet f, double excess = 0) {
    // Where the curvature says less than the range, the middle of the range is better than corners.
    const double half = RoundUp(f.v.Width() / 2);
    if (half < (f.ExcessOverQ() + f.ExcessUnderQ() + excess) / 2 + f.slack) {
      excess = 0;
      f.k = Pack<kCorners>::All(f.Middle());
      f.ds = IntervalPack<2 * D>::All({0, 0});
      f.slack = Above(half + kOutward * f.v.Magnitude());
    }
    for (int i = 0; i < 3; ++i) {
      if (colour[i] == 0) continue;
      Channel& c = channels_[static_cast<size_t>(i)];
      c.corners = c.corners + f.k * Pack<kCorners>::All(colour[i]);
      c.curvature = c.curvature + f.s() * colour[i];
      c.least = RoundDown(c.least + RoundDown(colour[i] * std::max(0.0, f.lo())));
      c.most = RoundUp(c.most + RoundUp(colour[i] * std::max(0.0, f.hi())));
      c.slack = RoundUp(c.slack + RoundUp(colour[i] * f.slack));
      c.excess = RoundUp(c.excess + RoundUp(colour[i] * excess));
    }
  }
  void AddConstant(const Rgb& colour) { Add(colour, Jet::Constant(1)); }

  // Largest error of the interpolant below relative to max(radiance, floor), for all rays. Infinite
  // where some bound is not a number, and where floats could not hold the corners.
  double Spread(double floor) const {
    double spread = 0;
    for (const Channel& c : channels_) {
      const double error = CentringOf(c).error + c.slack + kSumRounding * c.most;
      const double least = std::max(c.least, floor);
      const bool is_bounded = std::isfinite(error) && c.least >= 0 &&
                              c.most + error < std::numeric_limits<float>::max();
      if (!is_bounded) return std::numeric_limits<double>::infinity();
      // What is stored is off by kStorageRounding of itself, at most of c.most + error.
      spread = std::max(spread, Above((error + kStorageRounding * (c.most + error)) / least));
    }
    return spread;
  }

  Interpolant ToInterpolant() const {
    Interpolant interpolant{};
    for (size_t i = 0; i < 3; ++i) {
      double corners[kCorners];
      channels_[i].corners.Store(corners);
      const double shift = CentringOf(channels_[i]).shift;
      for (size_t m = 0; m < kCorners; ++m) {
        interpolant.corner[m][i] = static_cast<float>(std::max(0.0, corners[m] + shift));
      }
    }
    return interpolant;
  }

 private:
  // Of sums of up to a few hundred terms, and of the classical tracer's own value: both differ from
  // the sum of exact terms by roundings of 2^-53 each, the classical terms by those of a hit point.
  static constexpr double kSumRounding = 0x1p-36;

  struct Channel {
    Pack<kCorners> corners;
    IntervalPack<D> curvature;
    double least = 0, most = 0, slack = 0, excess = 0;
  };
  // The interpolant Q of the corners is above the sum f by at most L and below it by at most U
  // (corner_jet-inl.h). Where f is curved to one side, Q is moved to the middle between its bounds,
  // Q + (U - L) / 2, but not so far that a corner becomes negative.
  struct Centring {
    double shift = 0;
    double error = 0;  // of the moved interpolant, but for slack
  };
  static Centring CentringOf(const Channel& c) {
    const Pack<D> zero = Pack<D>::All(0);
    const double over = Above(SumOfLanes(Max(zero, -c.curvature.lo)) / 8);
    const double under = Above(SumOfLanes(Max(zero, c.curvature.hi)) / 8 + c.excess);
    Centring centring;
    const double lowest = std::max(0.0, SmallestLane(c.corners));
    centring.shift = std::max((over - under) / 2, -lowest);
    centring.error = Above(std::max(over - centring.shift, under + centring.shift));
    return centring;
  }
  Channel channels_[3];
};

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
