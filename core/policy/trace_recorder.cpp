#include "core/policy/trace_recorder.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include "absl/container/flat_hash_map.h"

namespace linetree {

uint32_t TraceRecorder::BeginFrame() {
  const std::lock_guard lock(mutex_);
  return next_frame_++;
}

void TraceRecorder::Add(uint32_t frame, std::span<const PolicyItem> items) {
  const std::lock_guard lock(mutex_);
  const size_t fitting = std::min(items.size(), most_events_ - events_.size());
  dropped_ += items.size() - fitting;
  constexpr uint64_t kMostBytes = std::numeric_limits<uint32_t>::max();
  for (const PolicyItem& item : items.first(fitting)) {
    events_.push_back({frame, item.id, static_cast<uint32_t>(std::min(item.bytes, kMostBytes)),
                       item.rebuild_ns, kNeverAgain});
  }
}

Trace TraceRecorder::Take() const {
  Trace trace;
  {
    const std::lock_guard lock(mutex_);
    trace = events_;
  }
  std::stable_sort(trace.begin(), trace.end(),
                   [](const TraceEvent& a, const TraceEvent& b) { return a.time < b.time; });
  absl::flat_hash_map<uint64_t, std::pair<uint32_t, float>> most;
  for (const TraceEvent& event : trace) {
    auto& [bytes, cost] = most[event.id];
    bytes = std::max(bytes, event.bytes);
    cost = std::max(cost, event.rebuild_ns);
  }
  for (TraceEvent& event : trace) std::tie(event.bytes, event.rebuild_ns) = most[event.id];
  LinkTrace(trace);
  return trace;
}

uint64_t TraceRecorder::event_count() const {
  const std::lock_guard lock(mutex_);
  return events_.size();
}

uint64_t TraceRecorder::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

}  // namespace linetree
