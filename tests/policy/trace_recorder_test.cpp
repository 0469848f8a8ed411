#include "core/policy/trace_recorder.h"

#include <gtest/gtest.h>

#include <vector>

namespace linetree {
namespace {

TEST(TraceRecorder, PutsFramesInOrderAndLinksThem) {
  TraceRecorder recorder;
  const uint32_t first = recorder.BeginFrame(), second = recorder.BeginFrame();
  const std::vector<PolicyItem> late = {{7, 300, 2}, {8, 10, 1}}, early = {{7, 100, 5}};
  recorder.Add(second, late);
  recorder.Add(first, early);
  const Trace trace = recorder.Take();
  ASSERT_EQ(trace.size(), 3u);
  EXPECT_EQ(trace[0].time, 0u);
  EXPECT_EQ(trace[0].id, 7u);
  EXPECT_EQ(trace[0].next, 1);
  EXPECT_EQ(trace[1].time, 1u);
  EXPECT_EQ(trace[2].next, kNeverAgain);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(trace[i].bytes, 300u) << "the most that it has had";
    EXPECT_EQ(trace[i].rebuild_ns, 5);
  }
}

TEST(TraceRecorder, CountsWhatFindsNoRoom) {
  TraceRecorder recorder(3);
  const std::vector<PolicyItem> items(2);
  for (int frame = 0; frame < 3; ++frame) recorder.Add(recorder.BeginFrame(), items);
  EXPECT_EQ(recorder.event_count(), 3u);
  EXPECT_EQ(recorder.dropped(), 3u);
}

}  // namespace
}  // namespace linetree
