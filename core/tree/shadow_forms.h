// Polynomials of low degree over the unit square, and the shadow function that is put together from
// them: drops what is decided everywhere.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/trace/shadow_function.h"

namespace linetree {

// c + s S + t T at (S, T) in [0, 1]^2.
struct Affine {
  double c = 0, s = 0, t = 0;

  friend Affine operator+(const Affine& a, const Affine& b) {
    return {a.c + b.c, a.s + b.s, a.t + b.t};
  }
  friend Affine operator-(const Affine& a, const Affine& b) { return a + b * -1; }
  friend Affine operator*(const Affine& a, double k) { return {a.c * k, a.s * k, a.t * k}; }
  friend Affine operator+(const Affine& a, double k) { return {a.c + k, a.s, a.t}; }
  // Bounds the absolute value.
  double Bound() const { return std::abs(c) + std::abs(s) + std::abs(t); }
};

// Coefficients of 1, s, t, s^2, st, t^2.
struct Quadratic {
  std::array<double, kQuadraticSize> k{};

  friend Quadratic operator+(Quadratic a, const Quadratic& b) {
    for (size_t i = 0; i < a.k.size(); ++i) a.k[i] += b.k[i];
    return a;
  }
  friend Quadratic operator*(Quadratic a, double factor) {
    for (double& x : a.k) x *= factor;
    return a;
  }
  friend Quadratic operator-(const Quadratic& a, const Quadratic& b) { return a + b * -1; }
};
inline Quadratic Product(const Affine& a, const Affine& b) {
  return {{a.c * b.c, a.c * b.s + a.s * b.c, a.c * b.t + a.t * b.c, a.s * b.s,
           a.s * b.t + a.t * b.s, a.t * b.t}};
}
inline Quadratic Square(const Affine& a) { return Product(a, a); }

// Enclosures of the values over the square: exact for Affine, by Bernstein coefficients for
// Quadratic; up to rounding of the coefficients' own.
struct Extent {
  double low, high;
};
inline Extent ExtentOf(const Affine& form) {
  return {form.c + std::min(form.s, 0.0) + std::min(form.t, 0.0),
          form.c + std::max(form.s, 0.0) + std::max(form.t, 0.0)};
}
Extent ExtentOf(const Quadratic& form);

inline constexpr int kMaxQuarterings = 8;

// What evaluation in floats may add, relative to the sum of the coefficients' sizes: the rounding
// of each (2^-24), of s and t (2^-25, twice in squares), of at most ten operations, and of
// kMaxQuarterings; and half as much again.
inline constexpr double kFormRounding = 0x1p-19;

// Adds the pieces of one object's shadow to `coefficients`.
class ShadowForms {
 public:
  explicit ShadowForms(std::vector<float>& coefficients) : coefficients_(coefficients) {}

  // The forms of a piece, the linear ones first; the object is not in the way where one is above
  // its margin, and is where all are below minus theirs.
  void Add(const Affine& form, double margin);
  void Add(const Quadratic& form, double margin);
  void EndPiece();
  // Whether one of the piece's forms has said already that the object is nowhere in the way: the
  // others need not be added.
  bool PieceMisses() const { return piece_misses_; }

  // All pieces of a function over a square, as they are over a quarter of it: bit 0 of `child`, the
  // upper half in s; bit 1, in t. Each time adds one rounding to floats, relative to the sum of the
  // coefficients' sizes at first: kMaxQuarterings of them are allowed for.
  void AddQuarter(const ShadowFunction& function, const float* coefficients, int child);

  // With all pieces ended. False when there is no function (something was not finite, or too long);
  // nothing is added then.
  bool Finish(Shadowing& everywhere, ShadowFunction& function);

 private:
  // Whether a form is needed.
  bool IsNeeded(const Extent& extent, double margin);
  // The same for one in double, whose margin gets the rounding of floats added.
  bool IsNeeded(const Extent& extent, double bound, double& margin);
  template <size_t kSize>
  void Push(const std::array<double, kSize>& form);
  bool IsEmpty() const;
  bool IsCutAway() const;

  // Linear forms of a piece.
  static constexpr uint8_t kMaxLines = 72;

  std::vector<float>& coefficients_;
  // Those of all pieces so far; what lies beyond size_ is not set.
  std::array<float, kMaxShadowPieces*(kMaxLines* kLinearSize + kQuadraticSize)> forms_;
  size_t size_ = 0, piece_begin_ = 0;
  ShadowFunction function_;
  uint8_t piece_lines_ = 0;
  bool piece_squared_ = false;
  bool piece_misses_ = false;
  bool blocks_ = false;
  bool is_valid_ = true;
};

}  // namespace linetree
