#include "core/render/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace linetree {
namespace {

using testing::HasSubstr;

TEST(OptionsTest, EveryFieldIsChecked) {
  EXPECT_TRUE(ValidateOptions({}).ok());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {-0.1, 1.1, nan}) {
    RenderOptions options;
    options.max_relative_error = bad;
    EXPECT_THAT(std::string(ValidateOptions(options).message()), HasSubstr("max_relative_error"));
    options = {};
    options.limits.min_weight = bad;
    EXPECT_THAT(std::string(ValidateOptions(options).message()), HasSubstr("min_weight"));
  }
  for (const int bad : {0, -1, kMaxPathDepth + 1}) {
    RenderOptions options;
    options.limits.max_depth = bad;
    EXPECT_THAT(std::string(ValidateOptions(options).message()), HasSubstr("max_depth"));
  }
}

TEST(OptionsTest, SizesAreBounded) {
  const RenderLimits limits;
  EXPECT_TRUE(ValidateSize(1, 1, limits).ok());
  EXPECT_EQ(ValidateSize(0, 5, limits).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(ValidateSize(5, -3, limits).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(ValidateSize(4'000'000'000, 1, limits).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(ValidateSize(16384, 16384, limits).code(), absl::StatusCode::kResourceExhausted);
}

}  // namespace
}  // namespace linetree
