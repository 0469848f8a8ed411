#include "core/policy/clairvoyant.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "core/policy/policies.h"
#include "core/policy/simulate.h"
#include "tests/policy/random_trace.h"

namespace linetree {
namespace {

constexpr int kItems = 6;

struct Tiny {
  Trace trace;
  uint64_t bytes[kItems] = {};  // by id
};

uint64_t BytesOf(const Tiny& tiny, uint32_t held) {
  uint64_t bytes = 0;
  for (int id = 0; id < kItems; ++id) bytes += (held >> id & 1) != 0 ? tiny.bytes[id] : 0;
  return bytes;
}

// The least cost by trying all sets of items after every event.
double CheapestOfAll(const Tiny& tiny, uint64_t budget) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  std::vector<double> costs(1 << kItems, kInf);
  costs[0] = 0;
  for (const TraceEvent& event : tiny.trace) {
    std::vector<double> after(costs.size(), kInf);
    const uint32_t own = 1u << event.id;
    for (uint32_t held = 0; held < costs.size(); ++held) {
      if (costs[held] == kInf) continue;
      const double cost = costs[held] + ((held & own) != 0 ? 0 : event.rebuild_ns);
      // Keeps any part of what is there now, with what has been fetched or without it.
      for (uint32_t kept = held | own;; kept = (kept - 1) & (held | own)) {
        if (BytesOf(tiny, kept) <= budget) after[kept] = std::min(after[kept], cost);
        if (kept == 0) break;
      }
    }
    costs = std::move(after);
  }
  return *std::min_element(costs.begin(), costs.end());
}

Tiny RandomTiny(test::Random& random, bool equal) {
  Tiny tiny;
  tiny.trace = test::RandomTrace(random, kItems, 5, 4, equal);
  for (int id = 0; id < kItems; ++id)
    tiny.bytes[id] = equal ? 1 : 1 + static_cast<uint64_t>(id) % 3;
  return tiny;
}

TEST(Clairvoyant, NobodyIsCheaperThanTheBoundThatAllSetsAreTriedFor) {
  test::Random random(11);
  double sum = 0, least = 1;
  constexpr int kRounds = 100;
  for (int round = 0; round < kRounds; ++round) {
    const Tiny tiny = RandomTiny(random, false);
    const auto budget = static_cast<uint64_t>(1 + random.Below(8));
    const double best = CheapestOfAll(tiny, budget);
    const double bound = LeastRebuildCost(tiny.trace, budget);
    ASSERT_LE(bound, best * (1 + 1e-9)) << "round " << round;
    sum += bound / best;
    least = std::min(least, bound / best);
  }
  EXPECT_GT(sum / kRounds, 0.9) << "the bound is near; least " << least;
}

TEST(Clairvoyant, EveryRoomAndNoRoom) {
  test::Random random(5);
  const Trace trace = test::RandomTrace(random, 50, 20, 10, false);
  double all = 0;
  for (const TraceEvent& event : trace) all += event.rebuild_ns;
  const WorkingSet set = WorkingSetOf(trace);
  EXPECT_NEAR(LeastRebuildCost(trace, set.bytes), set.rebuild_ns, 1e-6 * all);
  EXPECT_NEAR(LeastRebuildCost(trace, 0), all, 1e-6 * all);
  EXPECT_EQ(LeastRebuildCost({}, 10), 0);
}

// Frames of which one moment each is looked at, and more of them than moments.
TEST(Clairvoyant, NoPolicyIsCheaper) {
  test::Random random(3);
  for (const int frames : {300, 5000}) {
    const Trace trace = test::RandomTrace(random, 80, frames, 4, false);
    for (const uint64_t budget : {uint64_t{10}, uint64_t{60}}) {
      const double bound = LeastRebuildCost(trace, budget);
      for (const PolicyNote& note : AllPolicies()) {
        const auto result = Simulate(trace, note.name, {budget});
        ASSERT_TRUE(result.ok());
        EXPECT_GE(result->rebuild_ns, bound) << note.name;
      }
      EXPECT_GE(Simulate(trace, kBelady, {budget})->rebuild_ns, bound);
    }
  }
}

TEST(Clairvoyant, BeladyHasTheMostHitsOfAllForItemsThatAreEqual) {
  test::Random random(8);
  for (int round = 0; round < 100; ++round) {
    const Tiny tiny = RandomTiny(random, true);
    const auto budget = static_cast<uint64_t>(1 + random.Below(kItems));
    const auto belady = Simulate(tiny.trace, kBelady, {budget});
    ASSERT_TRUE(belady.ok());
    // Who must take in what it fetches may have to fetch as much, never more: what it drops for it
    // is what is used last, which may be that itself at once afterwards.
    const double best = CheapestOfAll(tiny, budget);
    ASSERT_GE(belady->rebuild_ns, best) << round;
    for (const PolicyNote& note : AllPolicies()) {
      ASSERT_LE(Simulate(tiny.trace, note.name, {budget})->hits, belady->hits) << note.name;
    }
    if (budget > 1) continue;
    ASSERT_EQ(belady->hits, Simulate(tiny.trace, "lru", {budget})->hits) << "there is no choice";
  }
}

}  // namespace
}  // namespace linetree
