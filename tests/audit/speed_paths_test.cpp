#include "core/audit/speed_paths.h"

#include <gtest/gtest.h>

#include "core/audit/speed_scenes.h"

namespace linetree {
namespace {

TEST(SpeedPathsTest, AWalkGoesAroundWhatIsLookedAt) {
  const Camera camera = MakeRoom(18, 1, false)->cameras[0];
  const std::vector<Camera> views = WalkViews(camera, 40);
  ASSERT_EQ(views.size(), 40u);
  EXPECT_EQ(views[20], camera);
  const double arm = Length(camera.eye - camera.look_at);
  for (size_t i = 1; i < views.size(); ++i) {
    EXPECT_NEAR(Length(views[i].eye - camera.look_at), arm, 1e-9);
    EXPECT_EQ(views[i].look_at, camera.look_at);
    const double step = Length(views[i].eye - views[i - 1].eye);
    EXPECT_GT(step, 0);
    EXPECT_LT(step, 0.02 * arm);
  }
}

TEST(SpeedPathsTest, TeleportsStayInTheOpen) {
  const auto scene = MakeRoom(40, 1, false);
  const Camera& camera = scene->cameras[0];
  const Tracer tracer(*scene);
  const std::vector<Camera> views = TeleportViews(*scene, camera, 50);
  ASSERT_EQ(views.size(), 50u);
  for (size_t i = 0; i < views.size(); ++i) {
    ASSERT_TRUE(ValidateCamera(views[i]).ok());
    const Vec3d way = views[i].eye - camera.eye;
    const Hit hit = tracer.Intersect(camera.eye, Normalized(way), RayStart{});
    ASSERT_TRUE(hit.IsHit());
    EXPECT_GT(hit.t, Length(way));
    EXPECT_FALSE(i > 0 && views[i].eye == views[i - 1].eye);
  }
  EXPECT_EQ(TeleportViews(*scene, camera, 50), views);
  EXPECT_FALSE(TeleportViews(*scene, camera, 50, /*seed=*/2) == views);
}

TEST(SpeedPathsTest, WhereNothingIsSeenTheCameraStays) {
  const auto scene = MakeRoom(18, 1, false);
  Camera camera = scene->cameras[0];
  camera.eye = {0, 100, 0};
  camera.look_at = {0, 200, 1};
  EXPECT_EQ(TeleportViews(*scene, camera, 2), std::vector<Camera>(2, camera));
}

TEST(SpeedPathsTest, EveryPathIsMeasuredOnItsFrames) {
  SpeedSetting setting;
  setting.scene = MakeRoom(18, 3, false);
  setting.options.width = setting.options.height = 32;
  setting.options.repeats = 2;
  SpeedFlights flights;
  flights.paths = {SpeedPath::kCold, SpeedPath::kWarm, SpeedPath::kWalk, SpeedPath::kTeleport};
  flights.still_frames = 3;
  flights.flight_frames = 4;
  const auto speeds = StudyPaths(setting, flights, nullptr);
  ASSERT_TRUE(speeds.ok()) << speeds.status();
  ASSERT_EQ(speeds->size(), 4u);
  for (size_t i = 0; i < 4; ++i) {
    const PathSpeed& speed = (*speeds)[i];
    EXPECT_EQ(speed.path, flights.paths[i]);
    EXPECT_EQ(speed.frames, i < 2 ? 1u : 4u);
    EXPECT_EQ(speed.flight.turns.size(), i < 2 ? 3u : 4u);
    EXPECT_EQ(speed.flight.beyond, 0u);
    EXPECT_LE(speed.least_ratio, speed.median_ratio);
  }
  // The cold and the warm frame are the first and the last of one flight.
  const std::vector<FrameSpeed::Turn>& turns = (*speeds)[0].flight.turns;
  EXPECT_EQ((*speeds)[0].median_ratio, turns[0].ratio);
  EXPECT_EQ((*speeds)[1].median_ratio, turns[2].ratio);
  EXPECT_EQ((*speeds)[1].least_ratio, std::min(turns[1].ratio, turns[2].ratio));
  EXPECT_EQ((*speeds)[1].flight.turns[0].ratio, turns[0].ratio);
}

}  // namespace
}  // namespace linetree
