// The truth that jets are held against: a function's value and its first and pure second
// derivatives at one point, by the exact formulas in 113 bits. The operations carry the names that
// jets have, so that one generic expression serves both.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "tests/support/random.h"

namespace linetree::test {

using Wide = __float128;

// To 2^-110: a Newton step on a root in 64 bits.
inline Wide WideRoot(Wide x) {
  const Wide guess = std::sqrt(static_cast<long double>(x));
  return (guess + x / guess) / 2;
}

template <size_t D>
struct Taylor {
  Wide f = 0;
  std::array<Wide, D> d{}, s{};

  // The coordinate that runs from `from` to `to` along one axis, at u in [0, 1].
  static Taylor Variable(size_t axis, double from, double to, double u) {
    Taylor t;
    const Wide edge = Wide(to) - Wide(from);
    t.f = Wide(from) + Wide(u) * edge;
    t.d[axis] = edge;
    return t;
  }
};

template <size_t D>
Taylor<D> ComposeTaylor(const Taylor<D>& a, Wide g, Wide g1, Wide g2) {
  Taylor<D> r;
  r.f = g;
  for (size_t i = 0; i < D; ++i) {
    r.d[i] = g1 * a.d[i];
    r.s[i] = g2 * a.d[i] * a.d[i] + g1 * a.s[i];
  }
  return r;
}

template <size_t D>
Taylor<D> operator+(const Taylor<D>& a, const Taylor<D>& b) {
  Taylor<D> r;
  r.f = a.f + b.f;
  for (size_t i = 0; i < D; ++i) {
    r.d[i] = a.d[i] + b.d[i];
    r.s[i] = a.s[i] + b.s[i];
  }
  return r;
}
template <size_t D>
Taylor<D> operator*(const Taylor<D>& a, double c) {
  return ComposeTaylor(a, a.f * Wide(c), Wide(c), Wide(0));
}
template <size_t D>
Taylor<D> operator+(const Taylor<D>& a, double c) {
  return ComposeTaylor(a, a.f + Wide(c), Wide(1), Wide(0));
}
template <size_t D>
Taylor<D> operator-(const Taylor<D>& a) {
  return a * -1.0;
}
template <size_t D>
Taylor<D> operator-(const Taylor<D>& a, const Taylor<D>& b) {
  return a + -b;
}
template <size_t D>
Taylor<D> operator*(const Taylor<D>& a, const Taylor<D>& b) {
  Taylor<D> r;
  r.f = a.f * b.f;
  for (size_t i = 0; i < D; ++i) {
    r.d[i] = a.f * b.d[i] + b.f * a.d[i];
    r.s[i] = a.f * b.s[i] + b.f * a.s[i] + 2 * a.d[i] * b.d[i];
  }
  return r;
}
template <size_t D>
Taylor<D> Square(const Taylor<D>& a) {
  return a * a;
}
template <size_t D>
Taylor<D> Inverse(const Taylor<D>& a) {
  const Wide g = 1 / a.f;
  return ComposeTaylor(a, g, -g * g, 2 * g * g * g);
}
template <size_t D>
Taylor<D> SquareRoot(const Taylor<D>& a) {
  const Wide g = WideRoot(a.f);
  return ComposeTaylor(a, g, 1 / (2 * g), -1 / (4 * a.f * g));
}
template <size_t D>
Taylor<D> InverseSquareRoot(const Taylor<D>& a) {
  const Wide g = 1 / WideRoot(a.f);
  return ComposeTaylor(a, g, -g * g * g / 2, 3 * g * g * g * g * g / 4);
}
// a^p, a > 0, to 2^-60 for p up to 1000: powl, in 64 bits.
template <size_t D>
Taylor<D> Power(const Taylor<D>& a, double p) {
  const auto power = [&](double q) -> Wide {
    return std::pow(static_cast<long double>(a.f), static_cast<long double>(q));
  };
  return ComposeTaylor(a, power(p), Wide(p) * power(p - 1), Wide(p) * Wide(p - 1) * power(p - 2));
}

// A random polynomial: a constant, linear terms, all products of two coordinates, some cubes. The
// same expression for jets and for the truth.
template <size_t D>
class RandomPolynomial {
 public:
  RandomPolynomial(Random& random, double scale) {
    const auto coefficient = [&] { return scale * random.Uniform(-1, 1); };
    constant_ = coefficient();
    for (size_t i = 0; i < D; ++i) {
      linear_[i] = coefficient();
      cubic_[i] = random.Below(3) == 0 ? coefficient() : 0;
      for (size_t j = 0; j <= i; ++j) quadratic_[i][j] = coefficient();
    }
  }

  template <class T>
  T operator()(const std::array<T, D>& x) const {
    T sum = x[0] * linear_[0] + constant_;
    for (size_t i = 1; i < D; ++i) sum = sum + x[i] * linear_[i];
    for (size_t i = 0; i < D; ++i) {
      for (size_t j = 0; j <= i; ++j) sum = sum + x[i] * x[j] * quadratic_[i][j];
      if (cubic_[i] != 0) sum = sum + T(Square(x[i])) * x[i] * cubic_[i];
    }
    return sum;
  }

 private:
  double constant_;
  std::array<double, D> linear_, cubic_;
  std::array<std::array<double, D>, D> quadratic_;
};

}  // namespace linetree::test
