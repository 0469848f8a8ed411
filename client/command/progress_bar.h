// A bar on standard error that shows how much is done.
#pragma once

#include <mutex>
#include <string>

namespace linetree {

// Whether standard error is a terminal: nobody wants bars in a log.
bool IsTerminal();

// Shows nothing unless `enabled`. The line is wiped when the bar is destroyed.
//
// Thread safety: Show may be called from any thread.
class ProgressBar {
 public:
  ProgressBar(bool enabled, std::string label);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // share in [0, 1]. Writes only when the whole per cent changes.
  void Show(double share);

  // The line for a share, without control characters.
  static std::string Line(const std::string& label, int percent);

 private:
  const bool enabled_;
  const std::string label_;
  std::mutex mutex_;
  int shown_percent_ = -1;  // guarded by mutex_
};

}  // namespace linetree
