#include "core/tree/shadow_forms.h"

#include <algorithm>
#include <utility>

namespace linetree {
namespace {

// Margins below this would leave the range of floats when forms are divided by them.
constexpr double kLeastMargin = 0x1p-400;
constexpr double kMostForm = 0x1p100;

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

// Cuts the square by one form after the other.
bool IsCutAway(const float* lines, size_t line_count) {
  // A convex polygon has at most one corner more after each cut.
  constexpr size_t kMaxCorners = 4 + kMaxPieceLines;
  std::array<std::array<Corner, kMaxCorners>, 2> buffers;
  Corner *corners = buffers[0].data(), *kept = buffers[1].data();
  corners[0] = {0, 0};
  corners[1] = {1, 0};
  corners[2] = {1, 1};
  corners[3] = {0, 1};
  size_t count = 4;
  const float* k = lines;
  for (size_t line = 0; line < line_count; ++line, k += kLinearSize) {
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
      if (left + 2 > kMaxCorners) return false;  // only by rounding, or of many forms
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

bool ShadowForms::IsNeeded(const Extent& extent, double bound, double& margin) {
  margin += kFormRounding * bound;
  // Also false for what is not a number.
  if (!(margin > kLeastMargin && bound < kMostForm * margin)) is_valid_ = false;
  if (extent.low > margin) piece_misses_ = true;
  return is_valid_ && !piece_misses_ && !(extent.high < -margin);
}

template <size_t kSize>
void ShadowForms::Push(const std::array<double, kSize>& form) {
  if constexpr (kSize == kLinearSize) {
    if (piece_lines_ == kMaxPieceLines) {
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
  return !(is_kept[0] || is_kept[1] || is_kept[2] || is_kept[3]) &&
         IsCutAway(forms_.data() + piece_begin_, piece_lines_);
}

void ShadowForms::EndPiece() {
  if (is_valid_) {
    if (piece_misses_ || IsEmpty()) {
      size_ = piece_begin_;
    } else if (piece_lines_ == 0 && !piece_squared_) {
      blocks_ = true;
    } else {
      squares_ |= (piece_squared_ ? 1u : 0u) << pieces_;
      lines_[pieces_++] = piece_lines_;
    }
  }
  piece_begin_ = size_;
  piece_lines_ = 0;
  piece_squared_ = piece_misses_ = false;
}

// Fields are set one by one, where they stay: what has just been written byte by byte is slow to be
// copied as a whole.
Shadowing ShadowForms::Finish(ShadowFunction& function) {
  const bool is_open = is_valid_ && !blocks_ && pieces_ > 0;
  function.begin = static_cast<uint32_t>(coefficients_.size());
  function.pieces = static_cast<uint8_t>(is_open ? pieces_ : 0);
  function.squares = static_cast<uint8_t>(is_open ? squares_ : 0);
  for (size_t i = 0; i < kMaxShadowPieces; ++i) {
    function.lines[i] = static_cast<uint8_t>(is_open ? lines_[i] : 0);
  }
  if (is_open) {
    coefficients_.insert(coefficients_.end(), forms_.begin(),
                         forms_.begin() + static_cast<std::ptrdiff_t>(size_));
  }
  if (!is_valid_ || is_open) return Shadowing::kUnknown;
  return blocks_ ? Shadowing::kBlocks : Shadowing::kMisses;
}

}  // namespace linetree
