// What floats make of shadow functions, against the room that their margins leave for it.
#include "core/tree/shadow_forms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "core/tree/shadow_quarters.h"
#include "tests/support/random.h"

namespace linetree::test {
namespace {

// One form as a function of its own, in units of its margin, over a square that is divided about a
// point again and again.
class FormOfFloats {
 public:
  FormOfFloats(const Quadratic& form, bool is_linear) : is_linear_(is_linear) {
    ShadowForms forms(coefficients_);
    // No margin but that for rounding.
    if (is_linear) {
      forms.Add(Affine{form.k[0], form.k[1], form.k[2]}, 0);
    } else {
      forms.Add(form, 0);
    }
    End(forms);
  }

  // False where the form is decided all over the square, so that there is none.
  bool IsThere() const { return function_.pieces == 1; }

  void Divide(double& s, double& t) {
    const int i = s >= 0.5 ? 1 : 0, j = t >= 0.5 ? 1 : 0;
    s = 2 * s - i;
    t = 2 * t - j;
    const std::vector<float> above = std::move(coefficients_);
    coefficients_.clear();
    const ShadowFunction function = std::exchange(function_, {});
    ShadowQuarters quarters;
    quarters.Begin({&function, 1}, above, i + 2 * j);
    quarters.At(0, coefficients_, function_);
  }

  // As ShadowingAt evaluates it.
  float At(float s, float t) const {
    const float* c = coefficients_.data();
    if (is_linear_) return c[0] + c[1] * s + c[2] * t;
    return c[0] + (c[1] + c[3] * s + c[4] * t) * s + (c[2] + c[5] * t) * t;
  }

 private:
  void End(ShadowForms& forms) {
    forms.EndPiece();
    forms.Finish(function_);
  }

  const bool is_linear_;
  std::vector<float> coefficients_;
  ShadowFunction function_;
};

struct Trial {
  Quadratic form;
  double s = 0, t = 0;
  double value = 0;  // at (s, t), in units of the margin: decisions are made at -1 and 1
};

long double Exact(const Trial& at, bool is_linear) {
  const auto& k = at.form.k;
  const long double s = at.s, t = at.t;
  const long double linear = k[0] + k[1] * s + k[2] * t;
  return is_linear ? linear : linear + k[3] * s * s + k[4] * s * t + k[5] * t * t;
}

double BoundOf(const Quadratic& form, bool is_linear) {
  double bound = 0;
  for (size_t i = 0; i < (is_linear ? kLinearSize : kQuadraticSize); ++i) {
    bound += std::abs(form.k[i]);
  }
  return bound;
}

// How far the floats are off, in units of the margin for rounding; 0 where none are left.
double ErrorOverMargin(const Trial& trial, bool is_linear, int quarterings) {
  FormOfFloats floats(trial.form, is_linear);
  double s = trial.s, t = trial.t;
  for (int q = 0; q < quarterings && floats.IsThere(); ++q) floats.Divide(s, t);
  if (!floats.IsThere()) return 0;
  const double margin = kFormRounding * BoundOf(trial.form, is_linear);
  const auto exact = Exact(trial, is_linear) / static_cast<long double>(margin);
  const float found = floats.At(static_cast<float>(s), static_cast<float>(t));
  return static_cast<double>(std::abs(exact - static_cast<long double>(found)));
}

// One number is changed: by much, or by some of its last bits as a float, along which the error is
// a saw's tooth that can be climbed.
Trial Changed(const Trial& from, bool is_linear, Random& random) {
  Trial to = from;
  const double change = random.Uniform(-1, 1) * random.LogUniform(1e-10, 0.3);
  const int which = 1 + random.Below(is_linear ? 5 : 8);
  if (which < (is_linear ? 3 : 6)) to.form.k[static_cast<size_t>(which)] += change;
  if (which == 6 || (is_linear && which == 3)) to.s = std::clamp(to.s + change, 0.0, 1.0);
  if (which == 7 || (is_linear && which == 4)) to.t = std::clamp(to.t + change, 0.0, 1.0);
  if (which == (is_linear ? 5 : 8)) to.value = std::clamp(to.value + change, -1.0, 1.0);
  to.form.k[0] = 0;
  to.form.k[0] = -static_cast<double>(Exact(to, is_linear));
  to.form.k[0] += to.value * kFormRounding * BoundOf(to.form, is_linear);
  return to;
}

double LargestError(bool is_linear, int quarterings, uint64_t seed) {
  Random random(seed);
  double largest = 0;
  for (int start = 0; start < 20; ++start) {
    Trial best = Changed({}, is_linear, random);
    best.s = random.Unit();
    best.t = random.Unit();
    for (double& k : best.form.k) k = random.Uniform(-1, 1);
    double error = 0;
    for (int step = 0; step < 3000; ++step) {
      const Trial tried = Changed(best, is_linear, random);
      const double its = ErrorOverMargin(tried, is_linear, quarterings);
      if (its < error) continue;
      error = its;
      best = tried;
    }
    largest = std::max(largest, error);
  }
  return largest;
}

// The bound adds up what does not come together: roundings are half as large on average and of
// either sign, and every division about a point halves coefficients and with them what later
// roundings add. A twentieth of the margin is reached (linear forms alone: 0.047): a margin four
// times as small would still hold.
TEST(ShadowForms, FloatsKeepToTheirMargin) {
  double of_all = 0;
  for (const bool is_linear : {true, false}) {
    for (const int quarterings : {0, 1, 4, kMaxQuarterings}) {
      const double largest = LargestError(is_linear, quarterings, 1);
      std::printf("%s, divided %d times: error / margin %.3f\n", is_linear ? "linear" : "quadratic",
                  quarterings, largest);
      EXPECT_LE(largest, 1);
      of_all = std::max(of_all, largest);
    }
  }
  EXPECT_GT(of_all, 0.05);
}

}  // namespace
}  // namespace linetree::test
