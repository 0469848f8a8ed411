// Sines and tangents of jets against long double: values, slopes, curvatures and the interpolation
// bound, at points of cells of one to four octants of the angle.
#include <gtest/gtest.h>

#include <numbers>

#include "core/jet/angle_functions-inl.h"
#include "tests/support/random.h"

namespace linetree {
namespace {

using Jet = scalar_jets::CornerJet<2>;

struct Truth {
  long double value, first, second;
};

// The angle is c + a u + b v; u, v in [0, 1].
struct Plane {
  double c, a, b;
  long double At(double u, double v) const {
    return static_cast<long double>(c) + static_cast<long double>(a) * u +
           static_cast<long double>(b) * v;
  }
};

template <class Fn>
void Check(const Jet& jet, const Plane& angle, Fn&& truth_at) {
  double corners[4];
  jet.k.Store(corners);
  double d_lo[2], d_hi[2], s_lo[2], s_hi[2];
  jet.d().lo.Store(d_lo);
  jet.d().hi.Store(d_hi);
  jet.s().lo.Store(s_lo);
  jet.s().hi.Store(s_hi);
  const double by[2] = {angle.a, angle.b};
  for (int i = 0; i <= 8; ++i) {
    for (int j = 0; j <= 8; ++j) {
      const double u = i / 8.0, v = j / 8.0;
      const Truth truth = truth_at(angle.At(u, v));
      ASSERT_LE(static_cast<long double>(jet.lo()), truth.value);
      ASSERT_GE(static_cast<long double>(jet.hi()), truth.value);
      for (int axis = 0; axis < 2; ++axis) {
        const long double slope = truth.first * by[axis];
        const long double curvature = truth.second * by[axis] * by[axis];
        ASSERT_LE(static_cast<long double>(d_lo[axis]), slope);
        ASSERT_GE(static_cast<long double>(d_hi[axis]), slope);
        ASSERT_LE(static_cast<long double>(s_lo[axis]), curvature);
        ASSERT_GE(static_cast<long double>(s_hi[axis]), curvature);
      }
      const double interpolated = (1 - u) * (1 - v) * corners[0] + u * (1 - v) * corners[1] +
                                  (1 - u) * v * corners[2] + u * v * corners[3];
      ASSERT_LE(std::abs(static_cast<long double>(interpolated) - truth.value),
                static_cast<long double>(jet.InterpolationError()) + 1e-15L);
    }
  }
}

// Angles over `from` to `to`, of all widths.
template <class Fn, class TruthFn>
void CheckAll(double from, double to, Fn&& function, TruthFn&& truth_at) {
  test::Random random(41);
  for (int n = 0; n < 2000; ++n) {
    const double width = (to - from) * std::pow(2.0, -random.Uniform(0, 12));
    const double share = random.Unit();
    const Plane angle{random.Uniform(from, to - width), width * share, width * (1 - share)};
    const Jet u = Jet::Variable(0, 0, 1), v = Jet::Variable(1, 0, 1);
    Jet x = u * angle.a + v * angle.b + angle.c;
    x.AssumeWithin(from, to);
    Check(function(x), angle, truth_at);
  }
}

constexpr double kQuarter = std::numbers::pi / 4;

TEST(AngleFunctions, SineIsEnclosed) {
  CheckAll(
      0, 2 * kQuarter, [](const Jet& x) { return Jet(Sine(x)); },
      [](long double x) {
        return Truth{std::sin(x), std::cos(x), -std::sin(x)};
      });
}

TEST(AngleFunctions, CosineIsEnclosed) {
  CheckAll(
      0, 2 * kQuarter, [](const Jet& x) { return Jet(Cosine(x)); },
      [](long double x) {
        return Truth{std::cos(x), -std::sin(x), -std::cos(x)};
      });
}

TEST(AngleFunctions, TangentIsEnclosed) {
  CheckAll(
      -kQuarter, kQuarter, [](const Jet& x) { return Jet(Tangent(x)); },
      [](long double x) {
        const long double t = std::tan(x), first = 1 + t * t;
        return Truth{t, first, 2 * t * first};
      });
}

TEST(AngleFunctions, TheLibraryIsWithinTheRounding) {
  test::Random random(43);
  for (int n = 0; n < 100'000; ++n) {
    const double x = random.Uniform(-kQuarter, kQuarter);
    const auto is_within = [](double value, long double exact) {
      return std::abs(static_cast<long double>(value) - exact) <=
             static_cast<long double>(scalar_jets::kAngleRounding) * std::abs(exact);
    };
    const auto exact = static_cast<long double>(x);
    ASSERT_TRUE(is_within(std::sin(x), std::sin(exact)));
    ASSERT_TRUE(is_within(std::cos(x), std::cos(exact)));
    ASSERT_TRUE(is_within(std::tan(x), std::tan(exact)));
  }
}

}  // namespace
}  // namespace linetree
