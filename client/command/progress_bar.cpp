#include "client/command/progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <utility>

#include "absl/strings/str_format.h"

namespace linetree {

bool IsTerminal() { return isatty(STDERR_FILENO) != 0; }

ProgressBar::ProgressBar(bool enabled, std::string label)
    : enabled_(enabled), label_(std::move(label)) {}

ProgressBar::~ProgressBar() {
  // Erase the line, so that what follows starts on a clean one.
  if (shown_percent_ >= 0) std::cerr << "\r\x1b[K" << std::flush;
}

void ProgressBar::Show(double share) {
  if (!enabled_) return;
  const int percent = static_cast<int>(100 * std::clamp(share, 0.0, 1.0));
  const std::lock_guard lock(mutex_);
  if (percent == shown_percent_) return;
  shown_percent_ = percent;
  std::cerr << '\r' << Line(label_, percent) << "\x1b[K" << std::flush;
}

std::string ProgressBar::Line(const std::string& label, int percent) {
  constexpr int kCells = 40;
  const auto full = static_cast<size_t>(percent * kCells / 100);
  return absl::StrFormat("%s [%s%s] %3d %%", label, std::string(full, '#'),
                         std::string(kCells - full, '.'), percent);
}

}  // namespace linetree
