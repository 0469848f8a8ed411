#include "core/math/check.h"

#include <gtest/gtest.h>

namespace linetree {
namespace {

TEST(CheckDeathTest, FalseEndsTheProgramAndSaysWhere) {
  EXPECT_DEATH(LT_CHECK(1 + 1 == 3), "1 \\+ 1 == 3.*|check_test.cpp");
}

TEST(Check, TrueIsEvaluatedOnce) {
  int calls = 0;
  LT_CHECK(++calls == 1);
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace linetree
