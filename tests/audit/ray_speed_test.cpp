#include "core/audit/ray_speed.h"

#include <gtest/gtest.h>

#include "core/audit/speed_scenes.h"

namespace linetree {
namespace {

RaySpeedOptions Small(double epsilon) {
  RaySpeedOptions options;
  options.width = 64;
  options.height = 48;
  options.repeats = 2;
  options.epsilon = epsilon;
  return options;
}

TEST(RaySpeedTest, BothKindsAreAnsweredInEveryWay) {
  WorkerPool pool(2);
  const auto scene = MakeRoom(18, 32, false);
  const auto speeds = StudyRaySpeed(scene, scene->cameras[0], Small(0.1), pool);
  ASSERT_TRUE(speeds.ok()) << speeds.status();
  EXPECT_FALSE(speeds->coherent.binned);
  EXPECT_TRUE(speeds->incoherent.binned);
  for (const RaySpeed& speed : {speeds->coherent, speeds->incoherent}) {
    EXPECT_EQ(speed.beyond, 0u);
    EXPECT_GT(speed.lane_rounding, 0);
    EXPECT_GT(speed.largest_classical_error, 0);
    EXPECT_LE(speed.largest_classical_error, speed.lane_rounding);
    EXPECT_LE(speed.largest_cached_error, 0.1 + speed.lane_rounding);
    for (const SpeedSpread& ns : speed.ns) EXPECT_GT(ns.least, 0);
    EXPECT_EQ(speed.rays % (64 * 48), 0u);
    EXPECT_GT(speed.rays, 0u);
  }
}

TEST(RaySpeedTest, TheErrorIsOfAllAnswersByPackets) {
  WorkerPool pool(1);
  const auto scene = MakeSpheres(20, 3);
  const auto speeds = StudyRaySpeed(scene, scene->cameras[0], Small(0), pool);
  ASSERT_TRUE(speeds.ok()) << speeds.status();
  // At epsilon 0 cached answers are the packets' own.
  EXPECT_EQ(speeds->coherent.largest_cached_error, speeds->coherent.largest_classical_error);
  EXPECT_EQ(speeds->incoherent.largest_cached_error, speeds->incoherent.largest_classical_error);
}

TEST(RaySpeedTest, BadOptionsAreRefused) {
  WorkerPool pool(1);
  const auto scene = MakeSpheres(20, 3);
  EXPECT_FALSE(StudyRaySpeed(scene, scene->cameras[0], Small(2), pool).ok());
}

}  // namespace
}  // namespace linetree
