#include "core/policy/policies.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/policy/simulate.h"
#include "tests/support/random.h"

namespace linetree {
namespace {

std::unique_ptr<EvictionPolicy> Make(std::string_view name, uint64_t budget) {
  auto made = MakePolicy(name, budget);
  EXPECT_TRUE(made.ok()) << made.status();
  return *std::move(made);
}

// Hits of a sequence of ids, each of one byte, a frame each.
uint64_t Hits(std::string_view policy, const std::vector<uint64_t>& ids, uint64_t budget,
              size_t per_frame = 1) {
  Trace trace;
  for (size_t i = 0; i < ids.size(); ++i) {
    trace.push_back({.time = static_cast<uint32_t>(i / per_frame), .id = ids[i]});
  }
  LinkTrace(trace);
  return Simulate(trace, policy, {budget})->hits;
}

class EveryPolicy : public testing::TestWithParam<std::string> {};

// Against the set of items that must be held: victims are among them, and stay until told.
TEST_P(EveryPolicy, PicksWhatIsHeldWhateverHappens) {
  test::Random random(1);
  const auto policy = Make(GetParam(), 200);
  std::map<uint64_t, PolicyItem> held;
  for (int step = 0; step < 30'000; ++step) {
    const auto id = static_cast<uint64_t>(random.Below(150));
    const int what = random.Below(20);
    if (what == 0) {
      policy->NextFrame();
    } else if (what == 1 && !held.empty()) {
      policy->Remove(held.begin()->first);
      held.erase(held.begin());
    } else if (what == 2 && !held.empty()) {
      policy->ExpectUse(held.rbegin()->first, random.Below(10));
    } else if (what == 3) {
      policy->SetBudget(static_cast<uint64_t>(100 + random.Below(200)));
    } else if (what == 4 && held.contains(id)) {
      held[id].bytes = static_cast<uint64_t>(1 + random.Below(9));
      policy->Change(held[id]);
    } else if (held.contains(id)) {
      policy->Access(id);
    } else {
      const PolicyItem item{id, static_cast<uint64_t>(1 + random.Below(9)), 1};
      if (what % 2 == 0) policy->Expect(item);
      policy->Insert(item);
      held[id] = item;
    }
    while (held.size() > 40) {
      const uint64_t victim = policy->PickVictim();
      ASSERT_TRUE(held.contains(victim)) << step;
      ASSERT_EQ(policy->PickVictim(), victim);
      if (what == 5) policy->Spare(victim);
      const uint64_t goes = what == 5 ? policy->PickVictim() : victim;
      ASSERT_TRUE(held.contains(goes)) << step;
      policy->Evict(goes);
      held.erase(goes);
    }
  }
}

TEST_P(EveryPolicy, GoesRoundWhereVictimsAreSpared) {
  const auto policy = Make(GetParam(), 64);
  for (uint64_t id = 0; id < 50; ++id) policy->Insert({id, 1, static_cast<float>(1 + id % 3)});
  policy->NextFrame();
  for (uint64_t id = 0; id < 50; id += 3) policy->Access(id);
  std::set<uint64_t> seen;
  for (int call = 0; call < 8 * 50; ++call) {
    const uint64_t victim = policy->PickVictim();
    seen.insert(victim);
    policy->Spare(victim);
  }
  EXPECT_GE(seen.size(), 16u) << "all of a queue";
  for (const uint64_t id : seen) policy->Evict(id);
  if (seen.size() < 50) {
    EXPECT_FALSE(seen.contains(policy->PickVictim()));
  }
}

TEST_P(EveryPolicy, HoldsWhatFits) {
  std::vector<uint64_t> ids;
  for (int round = 0; round < 10; ++round) {
    for (uint64_t id = 0; id < 30; ++id) ids.push_back(id);
  }
  EXPECT_EQ(Hits(GetParam(), ids, 30), 9u * 30) << "nothing has to go";
  EXPECT_EQ(Hits(GetParam(), ids, 0), 0u);
}

std::vector<std::string> Names() {
  std::vector<std::string> names;
  for (const PolicyNote& note : AllPolicies()) names.emplace_back(note.name);
  return names;
}
INSTANTIATE_TEST_SUITE_P(All, EveryPolicy, testing::ValuesIn(Names()), [](const auto& info) {
  std::string name = info.param;
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return "P" + name;
});

TEST(Policies, UnknownNamesGetAList) {
  const auto made = MakePolicy("mru", 1);
  ASSERT_FALSE(made.ok());
  EXPECT_NE(made.status().message().find("unknown policy 'mru', expected one of fifo, lru"),
            std::string::npos);
}

// What each is for, where another one fails.
TEST(Policies, FrequencyOutlivesAScan) {
  std::vector<uint64_t> ids;
  for (uint64_t round = 0; round < 40; ++round) {
    for (int again = 0; again < 3; ++again) {
      for (uint64_t id = 0; id < 10; ++id) ids.push_back(id);
    }
    for (uint64_t i = 0; i < 25; ++i) ids.push_back(1000 + 25 * round + i);
  }
  const uint64_t lru = Hits("lru", ids, 20);
  for (const char* name : {"lfu", "arc", "s3-fifo", "sieve", "w-tinylfu", "gdsf", "reuse"}) {
    EXPECT_GT(Hits(name, ids, 20), lru + 200) << name;
  }
}

TEST(Policies, ALoopLargerThanTheCacheIsNoUseToLru) {
  std::vector<uint64_t> ids;
  for (int round = 0; round < 60; ++round) {
    for (uint64_t id = 0; id < 100; ++id) ids.push_back(id);
  }
  EXPECT_EQ(Hits("lru", ids, 80, 5), 0u);
  EXPECT_GT(Hits("reuse", ids, 80, 5), ids.size() / 2) << "learns when things come back";
}

TEST(Policies, CostAndBytesCountWhereTheyAreSaidTo) {
  for (const char* name : {"gdsf", "reuse"}) {
    const auto policy = Make(name, 1000);
    policy->Insert({1, 10, 100});
    policy->Insert({2, 10, 1});
    policy->Insert({3, 100, 100});
    EXPECT_EQ(policy->PickVictim(), 2u) << name;
    policy->Evict(2);
    EXPECT_EQ(policy->PickVictim(), 3u) << name;
  }
}

TEST(Policies, WhatIsExpectedStays) {
  const auto policy = Make("reuse", 10);
  for (uint64_t id = 0; id < 10; ++id) policy->Insert({id, 1, 1});
  for (int frame = 0; frame < 3; ++frame) policy->NextFrame();
  for (uint64_t id = 0; id < 10; ++id) policy->ExpectUse(id, static_cast<double>(1 + id));
  EXPECT_EQ(policy->PickVictim(), 9u);
}

}  // namespace
}  // namespace linetree
