// Collects what frames use, for a trace.
//
// Thread safety: all methods may be called from any thread.
#pragma once

#include <mutex>
#include <span>

#include "core/policy/eviction_policy.h"
#include "core/policy/trace.h"

namespace linetree {

class TraceRecorder {
 public:
  // Events take 32 bytes each.
  static constexpr size_t kMostEvents = size_t{1} << 24;

  explicit TraceRecorder(size_t most_events = kMostEvents) : most_events_(most_events) {}

  // A frame's number, which is its time in the trace.
  uint32_t BeginFrame();
  // Items that the frame has used, each once. What finds no room is dropped.
  void Add(uint32_t frame, std::span<const PolicyItem> items);

  // All so far, in the order of frames, linked. An item counts with the most bytes and costs that
  // it has had: it grows while it is learnt.
  Trace Take() const;
  uint64_t event_count() const;
  uint64_t dropped() const;

 private:
  const size_t most_events_;
  mutable std::mutex mutex_;
  // Guarded by mutex_:
  uint32_t next_frame_ = 0;
  Trace events_;
  uint64_t dropped_ = 0;
};

}  // namespace linetree
