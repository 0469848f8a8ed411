// The shadow functions of a cell (shadow_function.h), as they are over a quarter of it: all of them
// at once.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/tree/shadow_forms.h"

namespace linetree {

// Linear forms over the unit square, one coefficient after the other, and what is known of each.
struct QuarteredLines {
  // Bits of `flags`. A form that is not needed is below -1 all over the quarter; one that misses,
  // above 1.
  static constexpr uint8_t kNeeded = 1, kMisses = 2;
  // The form leaves this point of the quarter below kCut: its corners and its middle.
  static constexpr uint8_t kKeeps00 = 4, kKeeps10 = 8, kKeeps11 = 16, kKeeps01 = 32,
                           kKeepsMiddle = 64;
  static constexpr uint8_t kKeepsCorners = kKeeps00 | kKeeps10 | kKeeps11 | kKeeps01;
  static constexpr uint8_t kKeeps = kKeepsCorners | kKeepsMiddle;

  std::vector<float> c, s, t;
  std::vector<uint8_t> flags;
};

// Quadratic forms, likewise; of the points they know the corners.
struct QuarteredSquares {
  std::array<std::vector<float>, kQuadraticSize> k;
  std::vector<uint8_t> flags;
};

// So many forms are looked at side by side.
inline constexpr size_t kQuarterBlock = 8;

// Linear forms, one after the other, `count` of them, over a quarter: bit 0 of `child`, the upper
// half in s; bit 1, in t. There is room in `quartered` for whole blocks.
void QuarterLines(const float* lines, size_t count, int child, QuarteredLines& quartered);
void QuarterLinesScalar(const float* lines, size_t count, int child, QuarteredLines& quartered);
// Quadratic forms in place.
void QuarterSquares(size_t count, int child, QuarteredSquares& squares);
void QuarterSquaresScalar(size_t count, int child, QuarteredSquares& squares);

// Each quartering adds one rounding to floats, relative to the sum of the coefficients' sizes at
// first: kMaxQuarterings of them are allowed for.
class ShadowQuarters {
 public:
  enum class Lanes { kSimd, kScalar };

  // The functions are those of a cell with their coefficients: one after the other, without gaps.
  // Keeps the first. Without SIMD, the plain twin, all that comes of it is the same, bit by bit.
  void Begin(std::span<const ShadowFunction> functions, std::span<const float> coefficients,
             int child, Lanes lanes = Lanes::kSimd);

  struct Says {
    // kUnknown: the function says where.
    Shadowing everywhere;
    // False: some points of the quarter are certainly not in the shadow, or all pieces are linear.
    bool may_block_all = false;
  };
  // What one of the functions, which has pieces, says over the quarter. Where it leaves anything
  // open, adds coefficients and sets `quarter`, which is empty before.
  Says At(size_t index, std::vector<float>& coefficients, ShadowFunction& quarter);

 private:
  // Where a piece begins in the columns, and what has been written to forms_.
  struct Place {
    size_t line, square, size;
  };
  struct Piece {
    uint8_t lines = 0;
    bool is_squared = false;
    bool is_empty = false;                   // nothing of the quarter is in it
    uint8_t keeps = QuarteredLines::kKeeps;  // those points that none of its forms leaves out
  };
  // Appends what is needed of the next piece to forms_.
  Piece TakePiece(size_t line_count, bool has_square, Place& place);

  std::span<const ShadowFunction> functions_;
  std::vector<uint32_t> first_squares_;  // by function
  QuarteredLines lines_;
  QuarteredSquares squares_;
  // One function's, whatever its numbers of forms.
  std::array<float,
             kMaxShadowPieces*(kLinearSize* std::numeric_limits<uint8_t>::max() + kQuadraticSize)>
      forms_;
};

}  // namespace linetree
