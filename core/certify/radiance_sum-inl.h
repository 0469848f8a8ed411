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

  // A term of every ray: colour * f. The colour is not negative.
  void Add(const Rgb& colour, const Jet& f) {
    // Bounded twice: by the curvature, and by the range in which both f and its interpolant lie.
    const double error = std::min(f.InterpolationError(), f.v.Width() + f.slack);
    for (int i = 0; i < 3; ++i) {
      if (colour[i] == 0) continue;
      Channel& c = channels_[static_cast<size_t>(i)];
      c.corners = c.corners + f.k * Pack<kCorners>::All(colour[i]);
      c.curvature = c.curvature + f.s() * colour[i];
      c.least = RoundDown(c.least + RoundDown(colour[i] * std::max(0.0, f.lo())));
      c.most = RoundUp(c.most + RoundUp(colour[i] * std::max(0.0, f.hi())));
      c.error = RoundUp(c.error + RoundUp(colour[i] * error));
      c.slack = RoundUp(c.slack + RoundUp(colour[i] * f.slack));
    }
  }
  void AddConstant(const Rgb& colour) { Add(colour, Jet::Constant(1)); }

  // Largest error of the interpolant below relative to max(radiance, floor), for all rays. Infinite
  // where some bound is not a number, and where floats could not hold the corners.
  double Spread(double floor) const {
    double spread = 0;
    for (const Channel& c : channels_) {
      const double summed =
          Above(SumOfLanes(Magnitudes(c.curvature)) / 8) + c.slack + kSumRounding * c.most;
      const double error = std::min(c.error + kSumRounding * c.most, summed);
      const double least = std::max(c.least, floor);
      const bool is_bounded = std::isfinite(c.error) && std::isfinite(summed) && c.least >= 0 &&
                              c.most + c.error < std::numeric_limits<float>::max();
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
      for (size_t m = 0; m < kCorners; ++m) {
        interpolant.corner[m][i] = static_cast<float>(std::max(0.0, corners[m]));
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
    double least = 0, most = 0, error = 0, slack = 0;
  };
  Channel channels_[3];
};

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
