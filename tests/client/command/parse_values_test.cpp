#include "client/command/parse_values.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace linetree {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ParseValues, Vectors) {
  EXPECT_EQ(*ParseVec3("1,2,3"), (Vec3d{1, 2, 3}));
  EXPECT_EQ(*ParseVec3("-1.5,+2e3,.25"), (Vec3d{-1.5, 2000, 0.25}));
  EXPECT_EQ(*ParseVec3("1, 2, 3"), (Vec3d{1, 2, 3}));
}

TEST(ParseValues, WhatIsNoVectorIsQuoted) {
  for (const char* text :
       {"", "1,2", "1,2,3,4", "1,2,", "a,b,c", "1 2 3", "1,2,nan", "1,inf,0", "1;2;3", "1,2,3x"}) {
    const absl::StatusOr<Vec3d> parsed = ParseVec3(text);
    EXPECT_EQ(parsed.status().code(), absl::StatusCode::kInvalidArgument) << text;
    EXPECT_THAT(
        std::string(parsed.status().message()),
        HasSubstr("expected three finite numbers x,y,z, found '" + std::string(text) + "'"));
  }
}

TEST(ParseValues, Numbers) {
  EXPECT_THAT(*ParseNumbers("0"), ElementsAre(0));
  EXPECT_THAT(*ParseNumbers("0,0.5,1"), ElementsAre(0, 0.5, 1));
  EXPECT_FALSE(ParseNumbers("").ok());
  EXPECT_FALSE(ParseNumbers("1,,2").ok());
}

TEST(ParseValues, NumberedNames) {
  EXPECT_EQ(*NumberedName("frame_%04d.png", 7), "frame_0007.png");
  EXPECT_EQ(*NumberedName("%d", 12345), "12345");
  EXPECT_EQ(*NumberedName("100%%_%d.exr", 3), "100%_3.exr");
}

TEST(ParseValues, NamesWithoutExactlyOneNumberAreRefused) {
  for (const char* pattern : {"frame.png", "%s.png", "%d_%d.png", "%", "%n", "%f.png"}) {
    const absl::StatusOr<std::string> name = NumberedName(pattern, 1);
    EXPECT_EQ(name.status().code(), absl::StatusCode::kInvalidArgument) << pattern;
    EXPECT_THAT(std::string(name.status().message()), HasSubstr("such as frame_%04d.png"));
  }
}

}  // namespace
}  // namespace linetree
