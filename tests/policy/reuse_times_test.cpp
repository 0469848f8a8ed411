#include "core/policy/reuse_times.h"

#include <gtest/gtest.h>

#include <initializer_list>

namespace linetree {
namespace {

TEST(ReuseTimes, BinsGrowWithTheAge) {
  size_t last = 0;
  for (uint32_t age = 1; age < 100'000; ++age) {
    const size_t bin = ReuseTimes::BinOf(age);
    ASSERT_GE(bin, last);
    ASSERT_LE(bin, last + 1) << "none is left out, at age " << age;
    if (age <= ReuseTimes::kExactAges) {
      ASSERT_EQ(bin, age - 1);
    }
    last = bin;
  }
  EXPECT_EQ(last, ReuseTimes::kAges - 1);
}

ReuseTimes Learnt(std::initializer_list<uint32_t> gaps, int times) {
  ReuseTimes reuse(2);
  for (int i = 0; i < times; ++i) {
    for (const uint32_t gap : gaps) reuse.Ended(1, gap);
  }
  reuse.Begin(1000);
  reuse.Learn();
  return reuse;
}

TEST(ReuseTimes, WhatComesBackSoonerIsWorthMore) {
  const ReuseTimes every = Learnt({1}, 1000), tenth = Learnt({10}, 1000);
  EXPECT_NEAR(every.UsesPerFrame(1, 1), 1 / 0.5, 0.1) << "in the middle of the frame";
  EXPECT_NEAR(tenth.UsesPerFrame(1, 1), 1 / 9.5, 0.01);
  EXPECT_GT(tenth.UsesPerFrame(1, 9), 4 * tenth.UsesPerFrame(1, 1)) << "nearly there";
  EXPECT_LT(tenth.UsesPerFrame(1, 12), 0.2) << "overdue";
  EXPECT_EQ(tenth.usual_gap(), 10u);
}

// Of items that come back after 2 or after 12 frames, those that have missed the first date wait.
TEST(ReuseTimes, TheRestOfAWaitIsWhatCounts) {
  const ReuseTimes reuse = Learnt({2, 12}, 1000);
  EXPECT_GT(reuse.UsesPerFrame(1, 1), reuse.UsesPerFrame(1, 3));
  EXPECT_LT(reuse.UsesPerFrame(1, 3), reuse.UsesPerFrame(1, 8));
}

TEST(ReuseTimes, WhatNeverCameBackCounts) {
  ReuseTimes reuse(1);
  for (int i = 0; i < 100; ++i) reuse.Ended(0, 1);
  const auto learn = [&](int open) {
    reuse.Begin(1000);
    for (int i = 0; i < open; ++i) reuse.Open(0, 50);
    reuse.Learn();
    return reuse.UsesPerFrame(0, 1);
  };
  EXPECT_GT(learn(0), 3 * learn(400));
}

// A class without spells of its own goes by all others.
TEST(ReuseTimes, StrangersAreTakenForTheOthers) {
  const ReuseTimes reuse = Learnt({4}, 1000);
  EXPECT_NEAR(reuse.UsesPerFrame(0, 1), reuse.UsesPerFrame(1, 1), 0.05);
}

}  // namespace
}  // namespace linetree
