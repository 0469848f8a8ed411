// Traces for tests.
#pragma once

#include "core/policy/trace.h"
#include "tests/support/random.h"

namespace linetree::test {

// `frames` frames of `per_frame` uses each, of `items` items of several sizes and costs.
inline Trace RandomTrace(Random& random, int items, int frames, int per_frame, bool equal) {
  Trace trace;
  for (int frame = 0; frame < frames; ++frame) {
    for (int i = 0; i < per_frame; ++i) {
      const auto id = static_cast<uint64_t>(random.Below(items));
      TraceEvent event{.time = static_cast<uint32_t>(frame), .id = id};
      if (!equal) {
        event.bytes = static_cast<uint32_t>(1 + id % 3);
        event.rebuild_ns = static_cast<float>(1 + (id * 7) % 5);
      }
      trace.push_back(event);
    }
  }
  LinkTrace(trace);
  return trace;
}

}  // namespace linetree::test
