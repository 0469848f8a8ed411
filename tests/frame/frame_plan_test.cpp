#include "core/frame/frame_plan.h"

#include <gtest/gtest.h>

namespace linetree {
namespace {

TEST(FramePlanTest, WhatIsNotKnownIsAsked) {
  const FramePlan plan(3);
  EXPECT_FALSE(plan.Skips(0));
  EXPECT_EQ(plan.CountSkipped(), 0u);
}

TEST(FramePlanTest, TreesThatCostMoreThanTheySaveAreSkipped) {
  FramePlan plan(3);
  plan.Book(0, 16, 300, 200);
  plan.Book(1, 16, 200, 1000);
  plan.Decide();
  EXPECT_TRUE(plan.Skips(0));
  EXPECT_FALSE(plan.Skips(1));
  EXPECT_DOUBLE_EQ(plan.SavedPerPoint(1), 50);
}

TEST(FramePlanTest, ObjectsNobodyHasSeenAreTakenForUsualOnes) {
  FramePlan plan(3);
  plan.Book(0, 16, 300, 200);
  plan.Decide();
  EXPECT_TRUE(plan.Skips(2));
  plan.Book(1, 16, 200, 2000);
  plan.Decide();
  EXPECT_FALSE(plan.Skips(2));
}

TEST(FramePlanTest, WhatIsOldCountsLess) {
  FramePlan plan(1);
  plan.Book(0, 16, 1000, 100);
  plan.Decide();
  EXPECT_TRUE(plan.Skips(0));
  for (int i = 0; i < 8; ++i) {
    plan.Book(0, 16, 100, 300);
    plan.Decide();
  }
  EXPECT_FALSE(plan.Skips(0));
}

TEST(FramePlanTest, AlwaysSkipsNothing) {
  FramePlan plan(2, /*always=*/true);
  plan.Book(0, 16, 1000, 1);
  plan.Decide();
  EXPECT_EQ(plan.CountSkipped(), 0u);
}

}  // namespace
}  // namespace linetree
