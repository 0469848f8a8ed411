// Polynomials of low degree over the unit square, and the shadow function that is put together from
// them: drops what is decided everywhere.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/trace/shadow_function.h"

namespace linetree {

// c + s S + t T at (S, T) in [0, 1]^2. Not set before it is: there are whole arrays of them.
struct Affine {
  double c, s, t;

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

// A piece is empty when nothing of the square is left below this many margins: the cut itself
// rounds by far less than one.
inline constexpr double kCut = 2;

// Linear forms of a piece, as ShadowForms adds them.
inline constexpr uint8_t kMaxPieceLines = 72;

// Whether nothing of the square is left below kCut of so many linear forms, one after the other.
// May be false where there are more than kMaxPieceLines of them.
bool IsCutAway(const float* lines, size_t count);

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

  // With all pieces ended. kUnknown: `function` says where, if it has pieces; without any there is
  // no function (something was not finite, or too long). Coefficients are added for pieces only.
  Shadowing Finish(ShadowFunction& function);

 private:
  // Whether a form is needed, whose margin gets the rounding of floats added.
  bool IsNeeded(const Extent& extent, double bound, double& margin);
  template <size_t kSize>
  void Push(const std::array<double, kSize>& form);
  bool IsEmpty() const;

  std::vector<float>& coefficients_;
  // Those of all pieces so far; what lies beyond size_ is not set.
  std::array<float, kMaxShadowPieces*(kMaxPieceLines* kLinearSize + kQuadraticSize)> forms_;
  size_t size_ = 0, piece_begin_ = 0;
  // Of the function: its pieces, of each the number of linear forms, and as bits which are squared.
  size_t pieces_ = 0;
  std::array<uint32_t, kMaxShadowPieces> lines_{};
  uint32_t squares_ = 0;
  uint8_t piece_lines_ = 0;
  bool piece_squared_ = false;
  bool piece_misses_ = false;
  bool blocks_ = false;
  bool is_valid_ = true;
};

}  // namespace linetree
