#include "core/audit/frame_speed.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/audit/speed_scenes.h"

namespace linetree {
namespace {

Frame FrameOf(const std::vector<float>& radiance) {
  Frame frame;
  frame.object.resize(radiance.size() / 3);
  frame.radiance.assign(radiance.begin(), radiance.end());
  return frame;
}

TEST(FrameSpeedTest, ErrorsAreThoseOfThePixelsWorstChannel) {
  FrameSpeed speed;
  // Relative to 2, to the floor, and to nothing that is a number.
  AddErrors(FrameOf({2, 2.25f, 2, 0.5f, 0, 0}), FrameOf({2, 2, 2, 0, 0, 0}), /*floor=*/1, 0.25,
            speed);
  EXPECT_EQ(speed.pixels, 2u);
  EXPECT_EQ(speed.beyond, 1u);
  EXPECT_DOUBLE_EQ(speed.largest_error, 0.5);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  AddErrors(FrameOf({nan, 0, 0}), FrameOf({0, 0, 0}), 1, 0.25, speed);
  EXPECT_EQ(speed.beyond, 2u);
}

TEST(FrameSpeedTest, OnePixelInAThousandDoesNotCountForTheShare) {
  std::vector<float> cached(3 * 2000, 1), classical(3 * 2000, 1);
  for (size_t p = 0; p < 3; ++p) cached[3 * p] = 1 + 0.125f * static_cast<float>(p + 1);
  FrameSpeed speed;
  AddErrors(FrameOf(cached), FrameOf(classical), 1, 0, speed);
  EXPECT_DOUBLE_EQ(speed.p999_error, 0.125);  // two of two thousand are larger
  EXPECT_DOUBLE_EQ(speed.largest_error, 0.375);
  EXPECT_EQ(speed.beyond, 3u);
}

TEST(FrameSpeedTest, EveryViewOfEveryRepeatIsCompared) {
  const auto scene = MakeRoom(18, 4, false);
  WorkerPool pool(1);
  FrameSpeedOptions options;
  options.width = 48;
  options.height = 32;
  options.repeats = 2;
  std::vector<double> shares;
  const std::vector<Camera> views(3, scene->cameras[0]);
  const auto speed =
      StudyFrameSpeed(scene, views, options, pool, [&](double share) { shares.push_back(share); });
  ASSERT_TRUE(speed.ok()) << speed.status();
  EXPECT_EQ(speed->turns.size(), 3u);
  EXPECT_EQ(speed->pixels, 2u * 3u * 48u * 32u);
  EXPECT_EQ(speed->beyond, 0u);
  EXPECT_LE(speed->p999_error, speed->largest_error);
  EXPECT_LE(speed->largest_error, options.epsilon);
  for (const FrameSpeed::Turn& turn : speed->turns) {
    EXPECT_LE(turn.cached.least, turn.cached.median);
    EXPECT_LE(turn.cached.median, turn.cached.most);
  }
  ASSERT_EQ(shares.size(), 6u);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_DOUBLE_EQ(shares.back(), 1);
  EXPECT_GT(BytesOf(speed->memory), 0u);
  EXPECT_EQ(speed->explanation.objects.size(), scene->objects.size());
}

TEST(FrameSpeedTest, WithoutEpsilonFramesAreEqual) {
  const auto scene = MakeRoom(18, 8, false);
  WorkerPool pool(1);
  FrameSpeedOptions options;
  options.width = options.height = 64;
  options.repeats = 1;
  options.epsilon = 0;
  const auto speed =
      StudyFrameSpeed(scene, std::vector<Camera>(2, scene->cameras[0]), options, pool);
  ASSERT_TRUE(speed.ok()) << speed.status();
  EXPECT_EQ(speed->largest_error, 0);
}

}  // namespace
}  // namespace linetree
