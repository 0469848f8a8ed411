#include "core/frame/frame_plan.h"

#include <gtest/gtest.h>

namespace linetree {
namespace {

// Of one packet; where `spent` is not given, all is known.
PacketWork Work(uint32_t asked, uint32_t classical) { return {16, asked, classical, asked, true}; }
PacketWork Work(uint32_t asked, uint32_t classical, uint32_t spent) {
  return {16, asked, classical, spent, false};
}

TEST(FramePlanTest, WhatIsNotKnownMayGrowButIsNotAsked) {
  const FramePlan plan(3);
  EXPECT_FALSE(plan.Skips(0));
  EXPECT_FALSE(plan.Pays(0));
  EXPECT_EQ(plan.CountSkipped(), 0u);
}

TEST(FramePlanTest, TreesAreAskedOnceTheyPayAsTheyAre) {
  FramePlan plan(2);
  plan.Book(0, Work(200, 1000, 1100));
  EXPECT_DOUBLE_EQ(plan.Decide().promised, 800);
  EXPECT_FALSE(plan.Skips(0));
  EXPECT_FALSE(plan.Pays(0));
  EXPECT_TRUE(plan.HopesAny());
  EXPECT_FALSE(plan.PaysAny());
  for (int i = 0; i < 3; ++i) plan.Book(0, Work(200, 1000));
  EXPECT_DOUBLE_EQ(plan.Decide().saved, 2400) << "they are asked from now on";
  EXPECT_TRUE(plan.Pays(0));
  EXPECT_TRUE(plan.PaysAny());
  EXPECT_FALSE(plan.HopesAny());
  plan.Book(0, Work(200, 1000));
  EXPECT_DOUBLE_EQ(plan.Decide().saved, 800);
  plan.Skip(0);
  EXPECT_FALSE(plan.Pays(0));
}

// To ask at all costs something everywhere: not where little of what is seen is worth it.
TEST(FramePlanTest, TreesAreAskedWhereTheyPayForAskingEverywhere) {
  FramePlan plan(2);
  const auto book = [&](int packets_without) {
    plan.Book(0, Work(200, 1000));
    for (int i = 0; i < packets_without; ++i) plan.Book(1, Work(120, 100));
    plan.Decide();
  };
  const int bearable = static_cast<int>(800 / (16 * kAskWork)) - 2;
  book(bearable);
  EXPECT_TRUE(plan.Pays(0));
  EXPECT_TRUE(plan.PaysAny());
  book(bearable + 2);
  EXPECT_TRUE(plan.Pays(0)) << "its own packets gain as much as before";
  EXPECT_FALSE(plan.PaysAny());
  plan.Decide();
  EXPECT_FALSE(plan.PaysAny()) << "where nothing was booked nothing is decided anew";
  book(0);
  EXPECT_TRUE(plan.PaysAny());
  plan.Decide();
  EXPECT_TRUE(plan.PaysAny());
}

// What is known, but not asked, saves nothing; what that would save is still a promise.
TEST(FramePlanTest, WhatIsKnownIsSavedWhereTreesAreAsked) {
  FramePlan plan(2);
  plan.Book(0, Work(200, 1000));
  for (int i = 0; i < 4; ++i) plan.Book(0, Work(200, 1000, 1100));
  plan.Book(1, Work(900, 1000));
  plan.Book(1, Work(400, 300));
  const FramePlan::Booked booked = plan.Decide();
  EXPECT_FALSE(plan.Pays(0));
  EXPECT_FALSE(plan.Pays(1));
  EXPECT_DOUBLE_EQ(booked.saved, 0);
  EXPECT_DOUBLE_EQ(booked.promised, 4 * 800 + 800) << "the other object has gained nothing";
}

TEST(FramePlanTest, TreesThatCostMoreThanTheySaveAreSkipped) {
  FramePlan plan(3);
  plan.Book(0, Work(300, 200));
  plan.Book(1, Work(200, 1000));
  plan.Decide();
  EXPECT_TRUE(plan.Skips(0));
  EXPECT_FALSE(plan.Skips(1));
  EXPECT_DOUBLE_EQ(plan.SavedPerPoint(1), 50);
}

TEST(FramePlanTest, ObjectsNobodyHasSeenAreTakenForUsualOnes) {
  FramePlan plan(3);
  plan.Book(0, Work(300, 200));
  plan.Decide();
  EXPECT_TRUE(plan.Skips(2));
  plan.Book(1, Work(200, 2000));
  plan.Decide();
  EXPECT_FALSE(plan.Skips(2));
}

TEST(FramePlanTest, WhatIsOldCountsLess) {
  FramePlan plan(1);
  plan.Book(0, Work(1000, 100));
  plan.Decide();
  EXPECT_TRUE(plan.Skips(0));
  for (int i = 0; i < 8; ++i) {
    plan.Book(0, Work(100, 300));
    plan.Decide();
  }
  EXPECT_FALSE(plan.Skips(0));
}

TEST(FramePlanTest, AlwaysSkipsNothing) {
  FramePlan plan(2, /*always=*/true);
  plan.Book(0, Work(1000, 1));
  plan.Decide();
  EXPECT_EQ(plan.CountSkipped(), 0u);
}

}  // namespace
}  // namespace linetree
