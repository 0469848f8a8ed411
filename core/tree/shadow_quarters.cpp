// shadow_quarters.h for every target of Highway; which one runs is decided at run time.
//
// Everything ordinary is included here, before code for special targets is: nothing of it may be
// compiled for one.
#include "core/tree/shadow_quarters.h"

#include <algorithm>

#include "core/jet/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/tree/shadow_quarters.cpp"
#include "hwy/foreach_target.h"
// After foreach_target.h.
#include "core/tree/shadow_quarters-inl.h"
#include "hwy/highway.h"

#if HWY_ONCE
namespace linetree {

HWY_EXPORT(QuarterLines);
HWY_EXPORT(QuarterSquares);

void QuarterLines(const float* lines, size_t count, int child, QuarteredLines& quartered) {
  HWY_DYNAMIC_DISPATCH(QuarterLines)(lines, count, child, quartered);
}
void QuarterSquares(size_t count, int child, QuarteredSquares& squares) {
  HWY_DYNAMIC_DISPATCH(QuarterSquares)(count, child, squares);
}

namespace {

uint8_t FlagsOf(const Extent& extent) {
  const int misses = extent.low > 1 ? QuarteredLines::kMisses : 0;
  const int needed = extent.high < -1 ? 0 : QuarteredLines::kNeeded;
  return static_cast<uint8_t>(misses | needed);
}
int KeepsAt(double value, uint8_t flag) { return value <= kCut ? flag : 0; }

}  // namespace

// s = (s' + i) / 2 with i of 0 and 1, and t likewise.
void QuarterLinesScalar(const float* lines, size_t count, int child, QuarteredLines& quartered) {
  const double i = child & 1, j = child >> 1 & 1;
  for (size_t at = 0; at < count; ++at) {
    const float* k = lines + at * kLinearSize;
    const double s = static_cast<double>(k[1]) / 2, t = static_cast<double>(k[2]) / 2;
    const double c = static_cast<double>(k[0]) + s * i + t * j;
    quartered.c[at] = static_cast<float>(c);
    quartered.s[at] = static_cast<float>(s);
    quartered.t[at] = static_cast<float>(t);
    const auto x00 = static_cast<double>(quartered.c[at]);
    const auto ds = static_cast<double>(quartered.s[at]);
    const auto dt = static_cast<double>(quartered.t[at]);
    quartered.flags[at] = static_cast<uint8_t>(
        FlagsOf(ExtentOf(Affine{c, s, t})) | KeepsAt(x00, QuarteredLines::kKeeps00) |
        KeepsAt(x00 + ds, QuarteredLines::kKeeps10) |
        KeepsAt(x00 + ds + dt, QuarteredLines::kKeeps11) |
        KeepsAt(x00 + dt, QuarteredLines::kKeeps01) |
        KeepsAt(x00 + ds * 0.5 + dt * 0.5, QuarteredLines::kKeepsMiddle));
  }
}

void QuarterSquaresScalar(size_t count, int child, QuarteredSquares& squares) {
  const double i = child & 1, j = child >> 1 & 1;
  for (size_t at = 0; at < count; ++at) {
    const auto k = [&](size_t index) { return static_cast<double>(squares.k[index][at]); };
    const double s = k(1) / 2, t = k(2) / 2, ss = k(3) / 4, st = k(4) / 4, tt = k(5) / 4;
    const Quadratic form{{k(0) + s * i + t * j + ss * i + st * i * j + tt * j,
                          s + 2 * ss * i + st * j, t + st * i + 2 * tt * j, ss, st, tt}};
    const auto [c, ds, dt, dss, dst, dtt] = form.k;
    const double right = c + ds + dss, top = c + dt + dtt;
    squares.flags[at] = static_cast<uint8_t>(
        FlagsOf(ExtentOf(form)) | KeepsAt(c, QuarteredLines::kKeeps00) |
        KeepsAt(right, QuarteredLines::kKeeps10) | KeepsAt(top, QuarteredLines::kKeeps01) |
        KeepsAt(right + dt + dtt + dst, QuarteredLines::kKeeps11));
    for (size_t index = 0; index < kQuadraticSize; ++index) {
      squares.k[index][at] = static_cast<float>(form.k[index]);
    }
  }
}

namespace {

void MakeRoom(size_t size, auto&... columns) {
  const size_t blocks = (size + kQuarterBlock - 1) / kQuarterBlock;
  const auto grow = [&](auto& column) {
    if (column.size() < blocks * kQuarterBlock) column.resize(2 * blocks * kQuarterBlock);
  };
  (grow(columns), ...);
}

}  // namespace

void ShadowQuarters::Begin(std::span<const ShadowFunction> functions,
                           std::span<const float> coefficients, int child, Lanes lanes) {
  functions_ = functions;
  first_squares_.resize(functions.size());
  // Also those of quadratic forms, as if they were two linear ones each: nobody asks about them.
  const size_t line_count = coefficients.size() / kLinearSize;
  auto& [c, s, t, flags] = lines_;
  MakeRoom(line_count, c, s, t, flags);
  auto& k = squares_.k;
  MakeRoom(functions.size() * kMaxShadowPieces, k[0], k[1], k[2], k[3], k[4], k[5], squares_.flags);
  size_t squares = 0;
  for (size_t i = 0; i < functions.size(); ++i) {
    const ShadowFunction& function = functions[i];
    first_squares_[i] = static_cast<uint32_t>(squares);
    if (function.squares == 0) continue;
    const float* at = coefficients.data() + function.begin;
    for (size_t piece = 0; piece < function.pieces; ++piece) {
      at += kLinearSize * function.lines[piece];
      if ((function.squares >> piece & 1) == 0) continue;
      for (size_t index = 0; index < kQuadraticSize; ++index) k[index][squares] = at[index];
      ++squares;
      at += kQuadraticSize;
    }
  }
  if (lanes == Lanes::kSimd) {
    QuarterLines(coefficients.data(), line_count, child, lines_);
    QuarterSquares(squares, child, squares_);
  } else {
    QuarterLinesScalar(coefficients.data(), line_count, child, lines_);
    QuarterSquaresScalar(squares, child, squares_);
  }
}

ShadowQuarters::Piece ShadowQuarters::TakePiece(size_t line_count, bool has_square, Place& place) {
  Piece piece;
  const uint8_t square_flags = has_square ? squares_.flags[place.square] : QuarteredLines::kKeeps;
  uint8_t some = square_flags;
  const size_t end = place.line + line_count;
  for (; place.line < end; ++place.line) {
    const uint8_t flags = lines_.flags[place.line];
    some = static_cast<uint8_t>(some | flags);
    // One that is not needed keeps all points.
    piece.keeps = static_cast<uint8_t>(piece.keeps & flags);
    // Nobody can predict which are needed, so all are written and those are counted.
    forms_[place.size] = lines_.c[place.line];
    forms_[place.size + 1] = lines_.s[place.line];
    forms_[place.size + 2] = lines_.t[place.line];
    const uint8_t needed = flags & QuarteredLines::kNeeded;
    place.size += kLinearSize * needed;
    piece.lines = static_cast<uint8_t>(piece.lines + needed);
  }
  // Most pieces hold one of the points: it would survive all cuts.
  const float* const lines = &forms_[place.size - kLinearSize * piece.lines];
  piece.is_empty = (some & QuarteredLines::kMisses) != 0 ||
                   (piece.keeps == 0 && piece.lines > 1 && IsCutAway(lines, piece.lines));
  if (!has_square) return piece;
  piece.keeps = static_cast<uint8_t>(piece.keeps & square_flags);
  piece.is_squared = (square_flags & QuarteredLines::kNeeded) != 0;
  for (size_t k = 0; piece.is_squared && k < kQuadraticSize; ++k) {
    forms_[place.size++] = squares_.k[k][place.square];
  }
  ++place.square;
  place.line += kQuadraticSize / kLinearSize;
  return piece;
}

ShadowQuarters::Says ShadowQuarters::At(size_t index, std::vector<float>& coefficients,
                                        ShadowFunction& quarter) {
  const ShadowFunction& function = functions_[index];
  Place place{function.begin / kLinearSize, first_squares_[index], 0};
  size_t pieces = 0;
  bool blocks = false;
  uint8_t squares = 0, blocked = 0;
  for (size_t i = 0; i < function.pieces; ++i) {
    const size_t begin = place.size;
    const Piece piece = TakePiece(function.lines[i], (function.squares >> i & 1) != 0, place);
    if (piece.is_empty) {
      place.size = begin;
      continue;
    }
    blocks = blocks || place.size == begin;
    blocked = static_cast<uint8_t>(blocked | piece.keeps);
    squares = static_cast<uint8_t>(squares | (piece.is_squared ? 1 : 0) << pieces);
    quarter.lines[pieces++] = piece.lines;
  }
  if (blocks || pieces == 0) return {blocks ? Shadowing::kBlocks : Shadowing::kMisses};
  // Field by field: what is put together and then copied as a whole has to wait for itself.
  quarter.begin = static_cast<uint32_t>(coefficients.size());
  quarter.pieces = static_cast<uint8_t>(pieces);
  quarter.squares = squares;
  coefficients.insert(coefficients.end(), forms_.begin(),
                      forms_.begin() + static_cast<std::ptrdiff_t>(place.size));
  // What a piece does not keep is above kCut in one of its forms: certainly not in its shadow.
  const bool all_corners = (~blocked & QuarteredLines::kKeepsCorners) == 0;
  return {Shadowing::kUnknown, squares != 0 && all_corners};
}

}  // namespace linetree
#endif
