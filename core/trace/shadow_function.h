// Whether one convex, opaque object hides one light from a point of a planar cell, as low-degree
// functions of the cell's coordinates (s, t) in [0, 1]^2: what shadow rays ask an object, without
// the ray.
//
// The shadow on a plane is a union of at most kMaxShadowPieces pieces, each of which is where all
// of its forms are negative. Forms are in units of their own uncertainty: above 1 a form is
// certainly positive in exact arithmetic and in the tracer's, below -1 negative, in between it says
// nothing and the ray has to be asked.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

namespace linetree {

enum class Shadowing : uint8_t { kMisses, kBlocks, kUnknown };

inline constexpr size_t kMaxShadowPieces = 3;
inline constexpr size_t kLinearSize = 3;     // of 1, s, t
inline constexpr size_t kQuadraticSize = 6;  // of 1, s, t, s^2, st, t^2

// Where the coefficients of one object and light are: piece after piece its linear forms, then its
// quadratic one.
struct ShadowFunction {
  uint32_t begin = 0;                             // among the cell's coefficients
  uint8_t pieces = 0;                             // 0: there is no function
  uint8_t squares = 0;                            // bit i: piece i has a quadratic form
  std::array<uint8_t, kMaxShadowPieces> lines{};  // linear forms of each piece
};

// The functions of a cell, one for every entry of its candidate lists.
struct CellShadows {
  const int32_t* objects = nullptr;  // all lists, one after the other
  const ShadowFunction* functions = nullptr;
  const float* coefficients = nullptr;
};

// All coefficients are finite.
inline Shadowing ShadowingAt(const ShadowFunction& function, const float* coefficients, float s,
                             float t) {
  const float* c = coefficients + function.begin;
  bool is_known = function.pieces > 0;
  for (size_t piece = 0; piece < function.pieces; ++piece) {
    float most = -std::numeric_limits<float>::infinity();
    for (size_t i = 0; i < function.lines[piece]; ++i, c += kLinearSize) {
      most = std::max(most, c[0] + c[1] * s + c[2] * t);
    }
    if ((function.squares >> piece & 1) != 0) {
      most = std::max(most, c[0] + (c[1] + c[3] * s + c[4] * t) * s + (c[2] + c[5] * t) * t);
      c += kQuadraticSize;
    }
    if (most < -1) return Shadowing::kBlocks;
    is_known = is_known && most > 1;
  }
  return is_known ? Shadowing::kMisses : Shadowing::kUnknown;
}

}  // namespace linetree
