// Width: jets are not only right but narrow.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/jet/jet_check.h"

namespace linetree::test {
namespace {

template <class T>
class CornerJetWidthTest : public testing::Test {};

template <size_t N>
struct Dimension {
  static constexpr size_t kD = N;
};
using Dimensions = testing::Types<Dimension<2>, Dimension<4>>;
TYPED_TEST_SUITE(CornerJetWidthTest, Dimensions);

// Largest |Q - f| at samples over what the jet says of it.
template <size_t D, class F>
double Tightness(const Box<D>& box, const F& f, Random& random, int samples) {
  const Jet<D> jet = f(box.Jets());
  const auto corners = CornersOf<D>(jet);
  Wide worst = 0;
  for (const Point<D>& u : Samples<D>(random, samples)) {
    const Wide off = Interpolate<D>(corners, u) - f(box.At(u)).f;
    worst = std::max(worst, off < 0 ? -off : off);
  }
  return static_cast<double>(worst) / jet.InterpolationError();
}

// A quadratic form without mixed terms, curved to one side: the lemma's bound is attained in the
// middle of the cell.
TYPED_TEST(CornerJetWidthTest, BoundIsAttainedByQuadratics) {
  constexpr size_t kD = TypeParam::kD;
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    Box<kD> box;
    for (size_t j = 0; j < kD; ++j) {
      box.from[j] = random.Uniform(-1, 1);
      box.to[j] = box.from[j] + random.LogUniform(1e-3, 1);
    }
    const double sign = random.Below(2) == 0 ? 1 : -1;
    std::array<double, kD> weights;
    for (double& w : weights) w = sign * random.Uniform(0.1, 1);
    const auto f = [&]<class T>(const std::array<T, kD>& x) -> T {
      T sum = Square(x[0]) * weights[0];
      for (size_t j = 1; j < kD; ++j) sum = sum + Square(x[j]) * weights[j];
      return sum;
    };
    const Jet<kD> jet = f(box.Jets());
    Point<kD> middle;
    middle.fill(0.5);
    const Wide off = Interpolate<kD>(CornersOf<kD>(jet), middle) - f(box.At(middle)).f;
    const double ratio = static_cast<double>(off < 0 ? -off : off) / jet.InterpolationError();
    // What is missing to 1 are roundings against the square of an edge of 1e-3.
    ASSERT_GT(ratio, 1 - 1e-6);
    ASSERT_LE(ratio, 1);
  }
}

// A function without curvature along any axis is interpolated exactly.
TYPED_TEST(CornerJetWidthTest, MultilinearFunctionsHaveNoError) {
  constexpr size_t kD = TypeParam::kD;
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Box<kD> box = RandomBox<kD>(random, 1);
    const auto f = [&]<class T>(const std::array<T, kD>& x) -> T {
      T product = x[0] + 2.0;
      for (size_t j = 1; j < kD; ++j) product = product * T(x[j] + 2.0);
      return product;
    };
    const Jet<kD> jet = f(box.Jets());
    ASSERT_LE(jet.InterpolationError(), 64 * kOutward * jet.v.Magnitude());
  }
}

// On cells of this edge ...
constexpr double kSmoothEdge = 1.0 / 16;
// ... chains of smooth functions are this many times as wide as they need to be, at most. The
// corners see the first order exactly; what is left is of the order of the edge.
constexpr double kRangeFactor = 1.05, kSlopeFactor = 1.6;
// And their interpolation error is this part of its bound, at least, for half of the cells.
constexpr double kMedianTightness = 0.85;

TYPED_TEST(CornerJetWidthTest, RangesOfSmoothFunctionsAreNarrow) {
  constexpr size_t kD = TypeParam::kD;
  Random random(3);
  std::vector<double> tightness;
  double widest = 0, steepest = 0;
  for (int i = 0; i < 200; ++i) {
    Box<kD> box;
    for (size_t j = 0; j < kD; ++j) {
      box.from[j] = random.Uniform(-1, 1);
      box.to[j] = box.from[j] + kSmoothEdge;
    }
    std::array<double, kD> w;
    for (double& x : w) x = random.Uniform(0.5, 1);
    // A cosine of a point light: (w.x + 1) / |x - light|, the light not near.
    const auto f = [&]<class T>(const std::array<T, kD>& x) -> T {
      T height = x[0] * w[0] + 1.0, square = Square(T(x[0] + 3.0));
      for (size_t j = 1; j < kD; ++j) {
        height = height + x[j] * w[j];
        square = square + Square(T(x[j] + 3.0));
      }
      return height * InverseSquareRoot(square);
    };
    const Jet<kD> jet = f(box.Jets());
    Wide least = 1e9, most = -1e9;
    std::array<Wide, kD> flat, steep;
    flat.fill(1e9);
    steep.fill(-1e9);
    for (const Point<kD>& u : Samples<kD>(random, 60)) {
      const Taylor<kD> t = f(box.At(u));
      least = std::min(least, t.f);
      most = std::max(most, t.f);
      for (size_t j = 0; j < kD; ++j) {
        flat[j] = std::min(flat[j], t.d[j]);
        steep[j] = std::max(steep[j], t.d[j]);
      }
    }
    widest = std::max(widest, jet.v.Width() / static_cast<double>(most - least));
    double lo[kD], hi[kD];
    jet.d().lo.Store(lo);
    jet.d().hi.Store(hi);
    for (size_t j = 0; j < kD; ++j) {
      steepest = std::max(steepest, (hi[j] - lo[j]) / static_cast<double>(steep[j] - flat[j]));
    }
    tightness.push_back(Tightness<kD>(box, f, random, 60));
  }
  std::sort(tightness.begin(), tightness.end());
  const double median = tightness[tightness.size() / 2];
  std::printf("D = %zu: range / needed %.3f, slopes / needed %.3f, median error / bound %.3f\n", kD,
              widest, steepest, median);
  EXPECT_LE(widest, kRangeFactor);
  EXPECT_LE(steepest, kSlopeFactor);
  EXPECT_GE(median, kMedianTightness);
  EXPECT_LE(tightness.back(), 1);
}

}  // namespace
}  // namespace linetree::test
