#include "core/audit/violation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>

namespace linetree {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(ViolationTest, ALineHoldsEveryBitOfTheRay) {
  Violation violation;
  violation.scene = "walls 0x7";
  violation.ray = {{0.1, -2.5, 1e-300}, {1.0 / 3, 0, -0.25}};
  violation.options.judge = JudgeKind::kCertified;
  violation.options.max_relative_error = 0.02;
  violation.options.limits = {6, 0.001};
  violation.answer = {0.1, 0.2, 0.3};
  violation.classical = {0.4, 0.5, 0.6};
  violation.error_over_allowed = 12.5;
  const std::string line = ToLine(violation);
  EXPECT_THAT(line, Not(HasSubstr("\n")));
  EXPECT_THAT(line, HasSubstr("scene=\"walls 0x7\" origin="));
  EXPECT_THAT(line, HasSubstr("max_depth=6 "));
  EXPECT_THAT(line, HasSubstr("judge=certified asked_as=ray "));
  EXPECT_THAT(line, HasSubstr("error_over_allowed=12.5"));
  Vec3d origin, direction;
  const std::string rays = line.substr(line.find("origin="));
  ASSERT_EQ(std::sscanf(rays.c_str(), "origin=%la,%la,%la direction=%la,%la,%la", &origin.x,
                        &origin.y, &origin.z, &direction.x, &direction.y, &direction.z),
            6);
  EXPECT_EQ(origin, violation.ray.origin);
  EXPECT_EQ(direction, violation.ray.direction);
}

}  // namespace
}  // namespace linetree
