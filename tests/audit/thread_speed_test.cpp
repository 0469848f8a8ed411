#include "core/audit/thread_speed.h"

#include <gtest/gtest.h>

#include "core/audit/speed_scenes.h"

namespace linetree {
namespace {

TEST(ThreadSpeedTest, PicturesDoNotDependOnTheNumberOfThreads) {
  FrameSpeedOptions options;
  options.width = options.height = 80;
  options.repeats = 2;
  const auto speed = StudyThreads(MakeRoom(18, 12, true), options, 3);
  ASSERT_TRUE(speed.ok()) << speed.status();
  EXPECT_EQ(speed->unequal, 0u);
  EXPECT_GT(speed->ratio, 0);
  EXPECT_GT(speed->classical_ratio, 0);
}

}  // namespace
}  // namespace linetree
