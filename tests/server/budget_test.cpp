#include "server/budget.h"

#include <gtest/gtest.h>

namespace linetree {
namespace {

TEST(BudgetTest, WhatIsTakenComesBackWhenItDies) {
  Budget budget(10);
  {
    const auto six = budget.Take(6);
    ASSERT_TRUE(six);
    EXPECT_EQ(budget.free(), 4u);
    EXPECT_FALSE(budget.Take(5));
    const auto four = budget.Take(4);
    EXPECT_TRUE(four);
    EXPECT_EQ(budget.free(), 0u);
  }
  EXPECT_EQ(budget.free(), 10u);
}

TEST(BudgetTest, AShareIsGivenBackOnceHoweverOftenItMoves) {
  Budget budget(10);
  {
    auto first = budget.Take(3);
    auto second = budget.Take(2);
    Budget::Share moved = *std::move(first);
    moved = *std::move(second);
    EXPECT_LE(budget.free(), 8u);
  }
  EXPECT_EQ(budget.free(), 10u);
}

TEST(BudgetTest, EnormousAmountsDoNotWrapAround) {
  Budget budget(10);
  const auto one = budget.Take(1);
  EXPECT_FALSE(budget.Take(~uint64_t{0}));
  EXPECT_EQ(budget.free(), 9u);
}

}  // namespace
}  // namespace linetree
