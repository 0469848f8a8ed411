#include "core/policy/trace.h"

#include <algorithm>

#include "absl/container/flat_hash_map.h"

namespace linetree {

void LinkTrace(Trace& trace) {
  absl::flat_hash_map<uint64_t, int64_t> next;
  for (size_t i = trace.size(); i-- > 0;) {
    const auto [found, is_last] = next.try_emplace(trace[i].id, kNeverAgain);
    trace[i].next = found->second;
    found->second = static_cast<int64_t>(i);
  }
}

WorkingSet WorkingSetOf(const Trace& trace) {
  WorkingSet set;
  absl::flat_hash_map<uint64_t, uint32_t> bytes;
  for (size_t i = 0; i < trace.size(); ++i) {
    const TraceEvent& event = trace[i];
    if (i == 0 || event.time != trace[i - 1].time) ++set.frames;
    const auto [found, is_first] = bytes.try_emplace(event.id, 0);
    if (is_first) set.rebuild_ns += event.rebuild_ns;
    set.bytes += std::max(event.bytes, found->second) - found->second;
    found->second = std::max(event.bytes, found->second);
  }
  set.items = bytes.size();
  return set;
}

}  // namespace linetree
