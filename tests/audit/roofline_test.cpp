#include "core/audit/roofline.h"

#include <gtest/gtest.h>

#include "core/audit/speed_scenes.h"

namespace linetree {
namespace {

TEST(RooflineTest, StagesAddUpToTheFrame) {
  WorkerPool pool(1);
  FrameSpeedOptions options;
  options.width = options.height = 64;
  options.repeats = 1;
  options.limits.max_depth = 8;
  const auto roofline = StudyRoofline(MakeRoom(18, 64, true), options, pool);
  ASSERT_TRUE(roofline.ok()) << roofline.status();
  const double sum = roofline->eye + roofline->branches + roofline->lights;
  EXPECT_NEAR(sum, roofline->classical, 1e-9 * sum);
  EXPECT_GT(roofline->eye, 0);
  EXPECT_DOUBLE_EQ(roofline->Best(),
                   roofline->classical / (roofline->classical - roofline->lights));
}

// Without lights nothing can be spared, with lights something can.
TEST(RooflineTest, TheBestIsTheFrameWithoutItsLights) {
  const Roofline roofline = {.eye = 4, .branches = 1, .lights = 15, .classical = 20};
  EXPECT_EQ(roofline.Best(), 4);
}

TEST(RooflineTest, WhatCannotBeRenderedIsAnError) {
  WorkerPool pool(1);
  FrameSpeedOptions options;
  options.width = 0;
  EXPECT_FALSE(StudyRoofline(MakeRoom(18, 1, false), options, pool).ok());
}

}  // namespace
}  // namespace linetree
