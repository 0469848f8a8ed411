#include "client/command/progress_bar.h"

#include <gtest/gtest.h>

namespace linetree {
namespace {

TEST(ProgressBar, FillsFromLeftToRight) {
  EXPECT_EQ(ProgressBar::Line("frame", 0),
            "frame [........................................]   0 %");
  EXPECT_EQ(ProgressBar::Line("frame", 50),
            "frame [####################....................]  50 %");
  EXPECT_EQ(ProgressBar::Line("frame", 100),
            "frame [########################################] 100 %");
}

TEST(ProgressBar, ShowsNothingWhenDisabled) {
  testing::internal::CaptureStderr();
  {
    ProgressBar bar(false, "frame");
    bar.Show(0.5);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(ProgressBar, WritesOncePerCentAndWipesItself) {
  testing::internal::CaptureStderr();
  {
    ProgressBar bar(true, "f");
    bar.Show(0.501);
    bar.Show(0.502);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "\r" + ProgressBar::Line("f", 50) + "\x1b[K" + "\r\x1b[K");
}

}  // namespace
}  // namespace linetree
