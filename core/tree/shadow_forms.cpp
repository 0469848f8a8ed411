#include "core/tree/shadow_forms.h"

#include <algorithm>

namespace linetree {
namespace {

// Margins below this would leave the range of floats when forms are divided by them.
constexpr double kLeastMargin = 0x1p-400;
constexpr double kMostForm = 0x1p100;

// A piece is empty when nothing of the square is left below this many margins: the cut itself
// rounds by far less than one.
constexpr double kCut = 2;

// Linear forms of a piece.
constexpr uint8_t kMaxLines = 72;

using Corner = std::array<double, 2>;
// A convex polygon has at most one corner more after each cut.
constexpr size_t kMaxCorners = 4 + kMaxLines;

}  // namespace

Extent ExtentOf(const Affine& form) {
  return {form.c + std::min(form.s, 0.0) + std::min(form.t, 0.0),
          form.c + std::max(form.s, 0.0) + std::max(form.t, 0.0)};
}

Extent ExtentOf(const Quadratic& form) {
  const auto& [c, s, t, ss, st, tt] = form.k;
  Extent extent{c, c};
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      const double value =
          c + (s * i + t * j) / 2 + st * (i * j) / 4 + (i == 2 ? ss : 0) + (j == 2 ? tt : 0);
      extent.low = std::min(extent.low, value);
      extent.high = std::max(extent.high, value);
    }
  }
  return extent;
}

bool ShadowForms::IsNeeded(const Extent& extent, double margin) {
  if (extent.low > margin) piece_misses_ = true;
  return is_valid_ && !piece_misses_ && !(extent.high < -margin);
}

bool ShadowForms::IsNeeded(const Extent& extent, double bound, double& margin) {
  margin += kFormRounding * bound;
  // Also false for what is not a number.
  if (!(margin > kLeastMargin && bound < kMostForm * margin)) is_valid_ = false;
  return IsNeeded(extent, margin);
}

void ShadowForms::Push(const double* form, size_t size, double margin) {
  if (size == kLinearSize && piece_lines_ == kMaxLines) {
    is_valid_ = false;
    return;
  }
  if (size == kLinearSize) ++piece_lines_;
  piece_squared_ = piece_squared_ || size == kQuadraticSize;
  for (size_t i = 0; i < size; ++i) coefficients_.push_back(static_cast<float>(form[i] / margin));
}

void ShadowForms::Add(const Affine& form, double margin) {
  if (!IsNeeded(ExtentOf(form), form.Bound(), margin)) return;
  const std::array<double, kLinearSize> k{form.c, form.s, form.t};
  Push(k.data(), k.size(), margin);
}

void ShadowForms::Add(const Quadratic& form, double margin) {
  double bound = 0;
  for (const double k : form.k) bound += std::abs(k);
  if (IsNeeded(ExtentOf(form), bound, margin)) Push(form.k.data(), form.k.size(), margin);
}

// s = (s' + i) / 2 with i of 0 and 1, and t likewise.
void ShadowForms::AddQuarter(const ShadowFunction& function, const float* coefficients, int child) {
  const double i = child & 1, j = child >> 1 & 1;
  const float* k = coefficients + function.begin;
  const auto at = [&](size_t index) { return static_cast<double>(k[index]); };
  for (size_t piece = 0; piece < function.pieces; ++piece) {
    for (size_t line = 0; line < function.lines[piece]; ++line, k += kLinearSize) {
      const double s = at(1) / 2, t = at(2) / 2;
      const std::array<double, kLinearSize> form{at(0) + s * i + t * j, s, t};
      if (IsNeeded(ExtentOf(Affine{form[0], s, t}), 1)) Push(form.data(), form.size(), 1);
    }
    if ((function.squares >> piece & 1) != 0) {
      const double s = at(1) / 2, t = at(2) / 2, ss = at(3) / 4, st = at(4) / 4, tt = at(5) / 4;
      const Quadratic form{{at(0) + s * i + t * j + ss * i + st * i * j + tt * j,
                            s + 2 * ss * i + st * j, t + st * i + 2 * tt * j, ss, st, tt}};
      if (IsNeeded(ExtentOf(form), 1)) Push(form.k.data(), form.k.size(), 1);
      k += kQuadraticSize;
    }
    EndPiece();
  }
}

// Cuts the square by all linear forms of the piece.
bool ShadowForms::IsEmpty() const {
  if (piece_lines_ < 2) return false;
  std::array<Corner, kMaxCorners> corners, kept;
  corners[0] = {0, 0};
  corners[1] = {1, 0};
  corners[2] = {1, 1};
  corners[3] = {0, 1};
  size_t count = 4;
  const float* k = coefficients_.data() + piece_begin_;
  for (uint8_t line = 0; line < piece_lines_; ++line, k += kLinearSize) {
    const auto value = [&](const Corner& x) {
      return static_cast<double>(k[0]) + static_cast<double>(k[1]) * x[0] +
             static_cast<double>(k[2]) * x[1] - kCut;
    };
    size_t left = 0;
    for (size_t i = 0; i < count; ++i) {
      const Corner &a = corners[i], &b = corners[(i + 1) % count];
      const double at_a = value(a), at_b = value(b);
      if (left + 2 > kMaxCorners) return false;  // only by rounding
      if (at_a <= 0) kept[left++] = a;
      if ((at_a <= 0) != (at_b <= 0)) {
        const double share = at_a / (at_a - at_b);
        kept[left++] = {a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share};
      }
    }
    if (left == 0) return true;
    std::copy_n(kept.begin(), left, corners.begin());
    count = left;
  }
  return false;
}

void ShadowForms::EndPiece() {
  if (is_valid_) {
    if (piece_misses_ || IsEmpty()) {
      coefficients_.resize(piece_begin_);
    } else if (piece_lines_ == 0 && !piece_squared_) {
      blocks_ = true;
    } else {
      if (piece_squared_) {
        function_.squares = static_cast<uint8_t>(function_.squares | 1 << function_.pieces);
      }
      function_.lines[function_.pieces++] = piece_lines_;
    }
  }
  piece_begin_ = coefficients_.size();
  piece_lines_ = 0;
  piece_squared_ = piece_misses_ = false;
}

bool ShadowForms::Finish(Shadowing& everywhere, ShadowFunction& function) {
  if (!is_valid_ || blocks_ || function_.pieces == 0) coefficients_.resize(begin_);
  if (!is_valid_) return false;
  function = {};
  if (blocks_ || function_.pieces == 0) {
    everywhere = blocks_ ? Shadowing::kBlocks : Shadowing::kMisses;
    return true;
  }
  everywhere = Shadowing::kUnknown;
  function = function_;
  function.begin = static_cast<uint32_t>(begin_);
  return true;
}

}  // namespace linetree
