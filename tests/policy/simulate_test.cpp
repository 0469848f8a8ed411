#include "core/policy/simulate.h"

#include <gtest/gtest.h>

#include "core/policy/policies.h"
#include "tests/policy/random_trace.h"

namespace linetree {
namespace {

TEST(Simulate, CountsRequestsBytesAndCosts) {
  Trace trace = {{0, 1, 10, 5}, {0, 2, 20, 7}, {1, 1, 10, 5}, {1, 3, 100, 11}, {2, 2, 20, 7}};
  LinkTrace(trace);
  EXPECT_EQ(trace[0].next, 2);
  EXPECT_EQ(trace[1].next, 4);
  EXPECT_EQ(trace[4].next, kNeverAgain);
  const WorkingSet set = WorkingSetOf(trace);
  EXPECT_EQ(set.items, 3u);
  EXPECT_EQ(set.bytes, 130u);
  EXPECT_EQ(set.frames, 3u);
  EXPECT_FLOAT_EQ(static_cast<float>(set.rebuild_ns), 23);
  const auto result = Simulate(trace, "lru", {.budget_bytes = 50});
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result->requests, 5u);
  EXPECT_EQ(result->hits, 2u) << "what is too large for the cache evicts nothing";
  EXPECT_EQ(result->evictions, 0u);
  EXPECT_EQ(result->requested_bytes, 160u);
  EXPECT_EQ(result->hit_bytes, 30u);
  EXPECT_DOUBLE_EQ(result->rebuild_ns, 23);
  EXPECT_EQ(Simulate(trace, "lru", {.budget_bytes = 2, .ignores_size = true})->evictions, 2u);
}

TEST(Simulate, UnknownPoliciesAreRefused) {
  EXPECT_EQ(Simulate({}, "mru", {}).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(Simulate, IsTheSameEveryTime) {
  test::Random random(4);
  const Trace trace = test::RandomTrace(random, 300, 200, 20, false);
  for (const PolicyNote& note : AllPolicies()) {
    EXPECT_EQ(Simulate(trace, note.name, {150})->rebuild_ns,
              Simulate(trace, note.name, {150})->rebuild_ns)
        << note.name;
  }
}

TEST(Simulate, ForesightComesNearToBelady) {
  test::Random random(11);
  const Trace trace = test::RandomTrace(random, 200, 400, 30, /*equal=*/true);
  const auto misses = [&](std::string_view policy, uint32_t foresight) {
    const auto result =
        Simulate(trace, policy, {.budget_bytes = 100, .foresight_frames = foresight});
    return static_cast<double>(result->requests - result->hits);
  };
  // Uses are independent of each other: nothing can be learnt from them.
  const double least = misses(kBelady, 0);
  EXPECT_GT(misses("reuse", 0), 1.3 * least);
  EXPECT_LT(misses("reuse", 4), 0.9 * misses("reuse", 0));
  EXPECT_LT(misses("reuse", 1000), 1.03 * least);
  EXPECT_GE(misses("reuse", 1000), least);
  EXPECT_EQ(misses("lru", 1000), misses("lru", 0)) << "nobody listens";
}

}  // namespace
}  // namespace linetree
