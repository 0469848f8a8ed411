#include "core/tree/shadow_forms.h"

#include <algorithm>
#include <utility>

namespace linetree {
namespace {

// Margins below this would leave the range of floats when forms are divided by them.
constexpr double kLeastMargin = 0x1p-400;
constexpr double kMostForm = 0x1p100;

// A piece is empty when nothing of the square is left below this many margins: the cut itself
// rounds by far less than one.
constexpr double kCut = 2;

using Corner = std::array<double, 2>;
}  // namespace

Extent ExtentOf(const Quadratic& form) {
  const auto& [c, s, t, ss, st, tt] = form.k;
  // Bernstein's coefficients: the corners, the middles of the sides, and the middle.
  const double right = c + s + ss, top = c + t + tt;
  const std::array<double, 9> values{c,
                                     c + s / 2,
                                     right,
                                     c + t / 2,
                                     c + (s + t) / 2 + st / 4,
                                     right + t / 2 + st / 2,
                                     top,
                                     top + s / 2 + st / 2,
                                     right + t + tt + st};
  Extent extent{c, c};
  for (const double value : values) {
    extent.low = std::min(extent.low, value);
    extent.high = std::max(extent.high, value);
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

template <size_t kSize>
void ShadowForms::Push(const std::array<double, kSize>& form) {
  if constexpr (kSize == kLinearSize) {
    if (piece_lines_ == kMaxLines) {
      is_valid_ = false;
      return;
    }
    ++piece_lines_;
  } else {
    piece_squared_ = true;
  }
  for (size_t i = 0; i < kSize; ++i) forms_[size_ + i] = static_cast<float>(form[i]);
  size_ += kSize;
}

void ShadowForms::Add(const Affine& form, double margin) {
  if (!IsNeeded(ExtentOf(form), form.Bound(), margin)) return;
  Push<kLinearSize>({form.c / margin, form.s / margin, form.t / margin});
}

void ShadowForms::Add(const Quadratic& form, double margin) {
  double bound = 0;
  for (const double k : form.k) bound += std::abs(k);
  if (!IsNeeded(ExtentOf(form), bound, margin)) return;
  std::array<double, kQuadraticSize> k = form.k;
  for (double& x : k) x /= margin;
  Push(k);
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
      if (IsNeeded(ExtentOf(Affine{form[0], s, t}), 1)) Push(form);
      if (piece_misses_) {
        k += static_cast<size_t>(function.lines[piece] - line) * kLinearSize;
        break;
      }
    }
    const bool is_square = (function.squares >> piece & 1) != 0;
    if (is_square && !piece_misses_) {
      const double s = at(1) / 2, t = at(2) / 2, ss = at(3) / 4, st = at(4) / 4, tt = at(5) / 4;
      const Quadratic form{{at(0) + s * i + t * j + ss * i + st * i * j + tt * j,
                            s + 2 * ss * i + st * j, t + st * i + 2 * tt * j, ss, st, tt}};
      if (IsNeeded(ExtentOf(form), 1)) Push(form.k);
    }
    if (is_square) k += kQuadraticSize;
    EndPiece();
  }
}

// Most pieces hold a corner of the square, which is quickly seen: it would survive all cuts.
bool ShadowForms::IsEmpty() const {
  if (piece_lines_ < 2) return false;
  bool is_kept[4] = {true, true, true, true};
  const float* k = forms_.data() + piece_begin_;
  for (uint8_t line = 0; line < piece_lines_; ++line, k += kLinearSize) {
    const double c = static_cast<double>(k[0]), s = static_cast<double>(k[1]),
                 t = static_cast<double>(k[2]);
    is_kept[0] = is_kept[0] && c <= kCut;
    is_kept[1] = is_kept[1] && c + s <= kCut;
    is_kept[2] = is_kept[2] && c + s + t <= kCut;
    is_kept[3] = is_kept[3] && c + t <= kCut;
  }
  return !(is_kept[0] || is_kept[1] || is_kept[2] || is_kept[3]) && IsCutAway();
}

// Cuts the square by all linear forms of the piece.
bool ShadowForms::IsCutAway() const {
  // A convex polygon has at most one corner more after each cut.
  constexpr size_t kMaxCorners = 4 + kMaxLines;
  std::array<std::array<Corner, kMaxCorners>, 2> buffers;
  Corner *corners = buffers[0].data(), *kept = buffers[1].data();
  corners[0] = {0, 0};
  corners[1] = {1, 0};
  corners[2] = {1, 1};
  corners[3] = {0, 1};
  size_t count = 4;
  const float* k = forms_.data() + piece_begin_;
  for (uint8_t line = 0; line < piece_lines_; ++line, k += kLinearSize) {
    const auto value = [&](const Corner& x) {
      return static_cast<double>(k[0]) + static_cast<double>(k[1]) * x[0] +
             static_cast<double>(k[2]) * x[1] - kCut;
    };
    size_t left = 0;
    const double first = value(corners[0]);
    double at_a = first;
    for (size_t i = 0; i < count; ++i) {
      const bool is_last = i + 1 == count;
      const Corner &a = corners[i], &b = corners[is_last ? 0 : i + 1];
      const double at_b = is_last ? first : value(b);
      if (left + 2 > kMaxCorners) return false;  // only by rounding
      if (at_a <= 0) kept[left++] = a;
      if ((at_a <= 0) != (at_b <= 0)) {
        const double share = at_a / (at_a - at_b);
        kept[left++] = {a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share};
      }
      at_a = at_b;
    }
    if (left == 0) return true;
    std::swap(corners, kept);
    count = left;
  }
  return false;
}

void ShadowForms::EndPiece() {
  if (is_valid_) {
    if (piece_misses_ || IsEmpty()) {
      size_ = piece_begin_;
    } else if (piece_lines_ == 0 && !piece_squared_) {
      blocks_ = true;
    } else {
      if (piece_squared_) {
        function_.squares = static_cast<uint8_t>(function_.squares | 1 << function_.pieces);
      }
      function_.lines[function_.pieces++] = piece_lines_;
    }
  }
  piece_begin_ = size_;
  piece_lines_ = 0;
  piece_squared_ = piece_misses_ = false;
}

bool ShadowForms::Finish(Shadowing& everywhere, ShadowFunction& function) {
  if (!is_valid_) return false;
  function = {};
  if (blocks_ || function_.pieces == 0) {
    everywhere = blocks_ ? Shadowing::kBlocks : Shadowing::kMisses;
    return true;
  }
  everywhere = Shadowing::kUnknown;
  function = function_;
  function.begin = static_cast<uint32_t>(coefficients_.size());
  coefficients_.insert(coefficients_.end(), forms_.begin(),
                       forms_.begin() + static_cast<std::ptrdiff_t>(size_));
  return true;
}

}  // namespace linetree
