// The time that studies measure with.
#pragma once

#include <time.h>

#include <chrono>

namespace linetree {

inline double NowUs() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double, std::micro>(now).count();
}

// What this thread has computed: other work of the machine does not count.
inline double ThreadUs() {
  timespec spent{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &spent);
  return 1e6 * static_cast<double>(spent.tv_sec) + 1e-3 * static_cast<double>(spent.tv_nsec);
}

}  // namespace linetree
