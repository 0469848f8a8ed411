// What a cache was asked for: the input of simulations.
#pragma once

#include <cstdint>
#include <vector>

namespace linetree {

inline constexpr int64_t kNeverAgain = -1;

struct TraceEvent {
  uint32_t time = 0;  // of a clock that never goes back; events of one frame have the same
  uint64_t id = 0;
  uint32_t bytes = 1;
  float rebuild_ns = 1;
  int64_t next = kNeverAgain;  // index of the next event with the same id
};

using Trace = std::vector<TraceEvent>;

// Fills in `next`.
void LinkTrace(Trace& trace);

struct WorkingSet {
  uint64_t items = 0;     // different ids
  uint64_t bytes = 0;     // of all of them, each as large as it ever is
  double rebuild_ns = 0;  // of building each once, at its first event
  uint64_t frames = 0;    // different times
};
WorkingSet WorkingSetOf(const Trace& trace);

}  // namespace linetree
