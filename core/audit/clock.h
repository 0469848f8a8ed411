// The time that studies measure with.
#pragma once

#include <chrono>

namespace linetree {

inline double NowUs() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double, std::micro>(now).count();
}

}  // namespace linetree
