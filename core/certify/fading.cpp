#include "core/certify/fading.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace linetree {
namespace {

// A polynomial of degree 4: of powers, or of Bernstein's polynomials over some interval.
using Polynomial = std::array<double, 5>;

// Rounding of all that is computed here, relative to the largest of what is added.
constexpr double kRounding = 0x1p-40;

// u_(n+1) of u_n.
Polynomial Next(const Polynomial& u, double a, int n) {
  Polynomial next{};
  for (size_t k = 0; k < 5; ++k) {
    const auto power = static_cast<double>(k);
    next[k] += (a * power - n - 0.5) * u[k];               // a r u' - (n + 1/2) u
    if (k + 1 < 5) next[k + 1] -= a * (power + 1) * u[k];  // -a r (r u' + u)
  }
  return next;
}

// The polynomial of powers in Bernstein's over [from, to].
Polynomial Bernstein(Polynomial u, double from, double to) {
  // Of s, r = from + s (to - from): Taylor's coefficients by Horner's rule, then scaled.
  for (size_t i = 0; i < 5; ++i) {
    for (size_t k = 4; k-- > i;) u[k] += from * u[k + 1];
  }
  double scale = 1;
  for (double& c : u) {
    c *= scale;
    scale *= to - from;
  }
  // s^k is the sum over i >= k of binomial(i, k) / binomial(4, k) times the i-th.
  constexpr double kBinomial[5][5] = {
      {1, 0, 0, 0, 0}, {1, 1, 0, 0, 0}, {1, 2, 1, 0, 0}, {1, 3, 3, 1, 0}, {1, 4, 6, 4, 1}};
  Polynomial b{};
  for (size_t i = 0; i < 5; ++i) {
    for (size_t k = 0; k <= i; ++k) b[i] += kBinomial[i][k] / kBinomial[4][k] * u[k];
  }
  return b;
}

double SumOfSizes(const Polynomial& u) {
  double sum = 0;
  for (const double c : u) sum += std::abs(c);
  return sum;
}

// Of |P| over r in [from, to], 0 <= from <= to <= 1, and v in [0, 1].
double MostOf(double power, double from, double to) {
  std::array<Polynomial, 5> u{};
  u[0][0] = 1;
  for (size_t n = 0; n < 4; ++n) u[n + 1] = Next(u[n], power / 2, static_cast<int>(n));
  const Polynomial u2 = Bernstein(u[2], from, to), u3 = Bernstein(u[3], from, to),
                   u4 = Bernstein(u[4], from, to);
  double most = 0;
  for (size_t i = 0; i < 5; ++i) {
    const double a = 12 * u2[i], b = 48 * u3[i], c = 16 * u4[i];
    // a + b v + c v^2 at the ends and the middle, and where tangents to it meet: quadratic
    // Bernstein coefficients of both halves.
    for (const double x : {a, a + b / 4, a + b / 2 + c / 4, a + 3 * b / 4 + c / 2, a + b + c}) {
      most = std::max(most, std::abs(x));
    }
  }
  const double size = 12 * SumOfSizes(u[2]) + 48 * SumOfSizes(u[3]) + 16 * SumOfSizes(u[4]);
  return most + kRounding * size;
}

}  // namespace

FadingBound BoundFading(const Light& light, double nearest, double farthest) {
  const double inverse = 1 / nearest, square = inverse * inverse;
  if (!(light.fade_distance > 0)) {
    return {inverse, 1 / farthest, 24 * square * square * inverse, 1};
  }
  const double near = FallOff(light, nearest), far = FallOff(light, farthest);
  const double from = std::max(0.0, 1 - near / 2 - kRounding);
  const double to = std::min(1.0, 1 - far / 2 + kRounding);
  FadingBound bound;
  bound.most = near * inverse * (1 + kRounding);
  bound.least = far / farthest * (1 - kRounding);
  bound.fourth = MostOf(light.fade_power, from, to) * bound.most * square * square;
  bound.slope = 1 + light.fade_power;
  return bound;
}

}  // namespace linetree
