#include "core/audit/stage_speed.h"

#include <gtest/gtest.h>

#include "core/audit/speed_scenes.h"

namespace linetree {
namespace {

// What they cost is the machine's affair; that they add up is not.
TEST(StageSpeedTest, StagesAddUpToTheFrame) {
  WorkerPool pool(1);
  FrameSpeedOptions options;
  options.width = options.height = 48;
  options.repeats = 2;
  for (const int warm_frames : {1, 3}) {
    const auto stages = StudyStages(MakeRoom(18, 16, true), options, warm_frames, pool);
    ASSERT_TRUE(stages.ok()) << stages.status();
    EXPECT_GT(stages->eye, 0);
    for (const StageSpeed::Legs& legs : {stages->classical, stages->warm}) {
      EXPECT_NEAR(stages->eye + legs.lights + legs.branches, legs.all, 1e-9 * legs.all);
    }
    EXPECT_EQ(stages->warm.all, stages->warm_learning.all);
    EXPECT_GT(stages->cold_learning.probe, 0);
    for (const StageSpeed::Learning& l : {stages->cold_learning, stages->warm_learning}) {
      EXPECT_GE(l.probe, 0) << "frames that promise nothing are not probed by themselves";
      EXPECT_GE(l.learn, 0);
      EXPECT_LT(l.probe + l.learn, l.all);
    }
    // Sixteen lights are worth learning about.
    EXPECT_GT(stages->cold_learning.learn, 0);
  }
}

}  // namespace
}  // namespace linetree
