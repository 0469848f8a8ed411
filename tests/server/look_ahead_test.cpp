// What a server renders before anybody asks: where a camera is going to be, and what the caches
// have learnt when it is there.
#include "server/look_ahead.h"

#include <thread>

#include "server/view_forecast.h"
#include "tests/server/running_server.h"

namespace linetree {
namespace {

Camera At(double x, double y = 0, double aim = 0) {
  Camera camera;
  camera.eye = {x, y, 8};
  camera.look_at = {aim, 0, 0};
  return camera;
}

TEST(ViewForecastTest, GoesOnAsItCame) {
  ViewForecast forecast;
  EXPECT_FALSE(forecast.After(At(0)));
  EXPECT_FALSE(forecast.After(At(1))) << "one step may be a jump";
  const auto next = forecast.After(At(2, 0.5));
  ASSERT_TRUE(next);
  EXPECT_EQ(next->eye, (Vec3d{3, 1, 8}));
  EXPECT_EQ(next->look_at, (Vec3d{0, 0, 0}));
}

TEST(ViewForecastTest, FollowsAnAimThatTurnsWhereTheEyeRests) {
  ViewForecast forecast;
  forecast.After(At(0, 0, 0));
  forecast.After(At(0, 0, 1));
  const auto next = forecast.After(At(0, 0, 2));
  ASSERT_TRUE(next);
  EXPECT_EQ(next->eye, (Vec3d{0, 0, 8}));
  EXPECT_EQ(next->look_at, (Vec3d{3, 0, 0}));
}

TEST(ViewForecastTest, SaysNothingAtRestAndAfterAJump) {
  ViewForecast forecast;
  forecast.After(At(0));
  forecast.After(At(1));
  EXPECT_TRUE(forecast.After(At(2)));
  EXPECT_FALSE(forecast.After(At(2))) << "rests";
  EXPECT_FALSE(forecast.After(At(3))) << "begins to move";
  EXPECT_TRUE(forecast.After(At(4)));
  EXPECT_FALSE(forecast.After(At(40))) << "jumps";
  EXPECT_FALSE(forecast.After(At(39))) << "turns round";
}

v1::GetStatsReply::SceneStats StatsOf(test::RunningServer& running) {
  return running.server().backend().GetStats({})->scenes(0);
}

class LookAheadTest : public testing::Test {
 protected:
  // A flight along a line that waits after each frame until `steps` frames have been rendered
  // ahead.
  static std::vector<v1::FrameEnd> FlyAlong(test::RunningServer& running, int frames, bool waits) {
    grpc::ClientContext context;
    const auto stream = running.stub().Fly(&context);
    std::vector<v1::FrameEnd> ends;
    for (int i = 0; i < frames; ++i) {
      v1::FlyRequest request;
      *request.mutable_frame() = test::SmallFrame(192, 192);
      request.mutable_frame()->mutable_options()->set_max_relative_error(0);
      v1::Camera& camera = *request.mutable_frame()->mutable_camera();
      camera.mutable_eye()->set_x(-4 + 0.5 * i);
      camera.mutable_eye()->set_y(2);
      camera.mutable_eye()->set_z(8);
      camera.mutable_look_at()->set_y(1);
      camera.mutable_up()->set_y(1);
      camera.set_fov_deg(45);
      EXPECT_TRUE(stream->Write(request));
      v1::FlyReply reply;
      while (stream->Read(&reply) && !reply.chunk().has_end()) {
      }
      ends.push_back(reply.chunk().end());
      while (waits && i >= 2 && StatsOf(running).ahead().frames() < static_cast<uint64_t>(i - 1)) {
        std::this_thread::yield();
      }
    }
    stream->WritesDone();
    EXPECT_TRUE(stream->Finish().ok());
    return ends;
  }
};

TEST_F(LookAheadTest, CellsAreThereBeforeTheyAreAskedFor) {
  test::RunningServer running;
  const auto ends = FlyAlong(running, 8, /*waits=*/true);
  const auto stats = StatsOf(running);
  EXPECT_EQ(stats.frames(), 8u);
  EXPECT_EQ(stats.totals().pixels(), 8u * 192 * 192) << "who has not asked does not count";
  EXPECT_GE(stats.ahead().frames(), 6u);
  EXPECT_GT(stats.ahead().cells_built(), 0u);
  EXPECT_GT(stats.ahead().cells_used(), 0u);
  EXPECT_LE(stats.ahead().cells_used(), stats.ahead().cells_built());
}

TEST_F(LookAheadTest, NothingIsBuiltAheadWhereThatIsOff) {
  ServerOptions options;
  options.prefetch = false;
  test::RunningServer running(options);
  FlyAlong(running, 6, /*waits=*/false);
  EXPECT_EQ(StatsOf(running).ahead().frames(), 0u);
  EXPECT_EQ(StatsOf(running).ahead().cells_built(), 0u);
}

}  // namespace
}  // namespace linetree
