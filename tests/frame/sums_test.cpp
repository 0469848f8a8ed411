// Sums in float, as packets evaluate them, against what the nodes were before they were rounded.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/certify/diffuse_summer.h"
#include "core/jet/simd_targets.h"
#include "tests/support/random.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/frame/sums_test.cpp"
#include "hwy/foreach_target.h"
// After foreach_target.h.
#include "hwy/highway.h"
#if HWY_TARGET != HWY_SCALAR
#include "core/frame/sums-inl.h"
#endif

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

#if HWY_TARGET != HWY_SCALAR
bool SumAtLanes(const DiffuseSum& sum, const float* s, const float* t, float* out) {
  Floats sums[3];
  SumAt(sum, Floats::Load(s), Floats::Load(t), sums);
  sums[0].Store(out);
  return true;
}
#else
bool SumAtLanes(const DiffuseSum&, const float*, const float*, float*) { return false; }
#endif

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace linetree {
namespace {

HWY_EXPORT(SumAtLanes);

constexpr size_t kLanes = 16;
using Weights = std::array<double, 4>;

Weights WeightsAt(double x) {
  const double a = 3 * x, b = 3 * x - 1, c = 3 * x - 2, d = 3 * x - 3;
  return {-b * c * d / 6, a * c * d / 2, -a * b * d / 2, a * b * c / 6};
}

// Nodes, none larger than 1, and a place.
struct SumCase {
  std::array<double, 16> nodes;
  double s, t;
};

// The error of sixteen places about the case's, the largest, relative to kNodeRounding.
double ErrorOverBound(const SumCase& c, double spacing, test::Random& random) {
  DiffuseSum sum;
  for (size_t k = 0; k < 16; ++k) sum.value[k].fill(static_cast<float>(c.nodes[k]));
  alignas(64) float s[kLanes], t[kLanes], out[kLanes];
  double exact[kLanes];
  for (size_t lane = 0; lane < kLanes; ++lane) {
    const double u = std::clamp(c.s + spacing * random.Uniform(-1, 1), 0.0, 1.0);
    const double v = std::clamp(c.t + spacing * random.Uniform(-1, 1), 0.0, 1.0);
    const Weights along_u = WeightsAt(u), along_v = WeightsAt(v);
    exact[lane] = 0;
    for (size_t k = 0; k < 16; ++k) exact[lane] += along_u[k % 4] * along_v[k / 4] * c.nodes[k];
    s[lane] = static_cast<float>(u);
    t[lane] = static_cast<float>(v);
  }
  if (!HWY_DYNAMIC_DISPATCH(SumAtLanes)(sum, s, t, out)) return -1;  // no vectors here
  double most = 0;
  for (size_t lane = 0; lane < kLanes; ++lane) {
    most = std::max(most, std::abs(static_cast<double>(out[lane]) - exact[lane]));
  }
  const double largest = *std::max_element(c.nodes.begin(), c.nodes.end());
  return most / (largest * kNodeRounding);
}

// By climbing: a quarter of the bound would be broken.
TEST(Sums, RoundingStaysWithinItsBoundAndUsesIt) {
  test::Random random(31);
  double worst = 0;
  for (int start = 0; start < 20; ++start) {
    SumCase best{{}, random.Unit(), random.Unit()};
    for (double& node : best.nodes) node = random.Unit();
    double most = 0;
    for (int i = 0; i < 3000; ++i) {
      SumCase next = best;
      for (double& node : next.nodes) {
        if (random.Below(6) == 0) node = std::clamp(node + random.Uniform(-0.5, 0.5), 0.01, 1.0);
      }
      next.s = std::clamp(next.s + random.Uniform(-0.05, 0.05), 0.0, 1.0);
      next.t = std::clamp(next.t + random.Uniform(-0.05, 0.05), 0.0, 1.0);
      const double error = ErrorOverBound(next, 0.01, random);
      ASSERT_GE(error, 0) << "packets need vectors";
      if (error <= most) continue;
      most = error;
      best = next;
    }
    worst = std::max(worst, most);
  }
  std::printf("largest rounding / bound %.3f\n", worst);
  EXPECT_LE(worst, 1);
  EXPECT_GT(worst, 0.25);
}

}  // namespace
}  // namespace linetree
#endif
