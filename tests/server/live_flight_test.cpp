// Flights that are steered: the client's library against a server.
#include <future>

#include "tests/server/running_server.h"

namespace linetree {
namespace {

FrameRequest View(int width, int height, double x = 0) {
  FrameRequest request;
  request.camera.eye = {x, 3, 8};
  request.camera.look_at = {0, 1, 0};
  request.width = width;
  request.height = height;
  request.options.mode = Mode::kClassical;
  return request;
}

PixelLayer<float> Rendered(const FrameRequest& request) {
  SceneHost host(test::BuiltBallScene());
  WorkerPool pool(1);
  return host.RenderFrame(request, pool)->radiance;
}

TEST(LiveFlightTest, TheNewestViewpointGetsItsFrameAndTheRestIsCounted) {
  test::RunningServer running;
  std::vector<LiveFrame> frames;
  std::promise<void> first;
  const auto flight = running.client().Steer("ball", {}, [&](LiveFrame frame) {
    frames.push_back(std::move(frame));
    if (frames.size() == 1) first.set_value();
  });
  // A frame that is under way while the others come.
  EXPECT_EQ(*flight->Look(View(16, 12)), 0u);
  first.get_future().wait();
  for (uint64_t view = 1; view < 200; ++view) {
    EXPECT_EQ(*flight->Look(View(40, 30, 0.01 * static_cast<double>(view))), view);
  }
  ASSERT_TRUE(flight->Land().ok()) << flight->Land();
  ASSERT_LT(frames.size(), 200u);
  for (size_t i = 1; i < frames.size(); ++i) EXPECT_GT(frames[i].view, frames[i - 1].view);
  const LiveFrame& last = frames.back();
  EXPECT_EQ(last.view, 199u);
  EXPECT_EQ(last.frame.radiance, Rendered(View(40, 30, 1.99)));
  EXPECT_FALSE(flight->Look(View(16, 12)).ok()) << "it has landed";
}

TEST(LiveFlightTest, AReducedFrameComesFirst) {
  test::RunningServer running;
  std::vector<LiveFrame> frames;
  const auto flight =
      running.client().Steer("ball", {.while_moving = LiveOptions::WhileMoving{.divisor = 4}},
                             [&](LiveFrame frame) { frames.push_back(std::move(frame)); });
  EXPECT_FALSE(flight->HasEndedBy(std::chrono::system_clock::now()));
  ASSERT_TRUE(flight->Look(View(70, 40)).ok());
  ASSERT_TRUE(flight->Land().ok()) << flight->Land();
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_TRUE(frames[0].reduced);
  EXPECT_EQ(frames[0].frame.radiance, Rendered(View(18, 10)));
  EXPECT_FALSE(frames[1].reduced);
  EXPECT_EQ(frames[1].frame.radiance, Rendered(View(70, 40)));
}

TEST(LiveFlightTest, WhatIsWrongEndsItWithTheServersWords) {
  test::RunningServer running;
  const auto flight = running.client().Steer("nobody", {}, [](const LiveFrame&) { FAIL(); });
  ASSERT_TRUE(flight->Look(View(8, 8)).ok());
  EXPECT_TRUE(flight->HasEndedBy(std::chrono::system_clock::time_point::max()));
  EXPECT_TRUE(absl::IsNotFound(flight->Land())) << flight->Land();
  EXPECT_TRUE(absl::IsNotFound(flight->Look(View(8, 8)).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(
      running.client().Steer("ball", {}, [](const LiveFrame&) {})->Look(View(0, 8)).status()));
}

TEST(LiveFlightTest, AServersFarewellIsNoEnd) {
  ServerOptions options;
  options.max_flight_s = std::chrono::seconds(1);
  test::RunningServer running(options);
  std::vector<uint64_t> views;
  std::promise<void> first;
  const auto flight = running.client().Steer("ball", {}, [&](const LiveFrame& frame) {
    views.push_back(frame.view);
    if (frame.view == 0) first.set_value();
  });
  ASSERT_TRUE(flight->Look(View(8, 8)).ok());
  first.get_future().wait();
  const auto open = [&] { return running.server().backend().flights().free(); };
  while (open() < options.limits.max_flights) {  // until the server has said farewell
    std::this_thread::yield();
  }
  ASSERT_TRUE(flight->Look(View(9, 9)).ok());
  EXPECT_TRUE(flight->Land().ok()) << flight->Land();
  EXPECT_EQ(views, (std::vector<uint64_t>{0, 1}));
}

TEST(LiveFlightTest, WhoeverGivesUpWaitsForNothing) {
  test::RunningServer running;
  FrameRequest endless = View(4000, 4000);
  endless.options.limits = {.max_depth = 16, .min_weight = 0};
  auto flight = running.client().Steer("ball", {}, [](const LiveFrame&) { FAIL(); });
  ASSERT_TRUE(flight->Look(endless).ok());
  flight.reset();
  running.ExpectServing();
}

TEST(LiveFlightTest, FramesComeInEveryForm) {
  test::RunningServer running;
  const FrameRequest view = View(30, 20);
  const PixelLayer<float> classical = Rendered(view);
  for (const FrameCodec codec : {FrameCodec::kFloat, FrameCodec::kHalf, FrameCodec::kExr,
                                 FrameCodec::kPng, FrameCodec::kJpeg}) {
    std::vector<Frame> frames;
    const FrameFormat format{.codec = codec};
    const auto flight = running.client().Steer("ball", {.format = format}, [&](LiveFrame live) {
      frames.push_back(std::move(live.frame));
    });
    ASSERT_TRUE(flight->Look(view).ok());
    ASSERT_TRUE(flight->Land().ok()) << flight->Land();
    auto single = running.client().RenderFrame("ball", view, "", format, nullptr);
    ASSERT_TRUE(single.ok()) << single.status();
    frames.push_back(*std::move(single));
    ASSERT_TRUE(running.client()
                    .Fly("ball", {view}, format,
                         [&](size_t, Frame frame) { frames.push_back(std::move(frame)); })
                    .ok());
    ASSERT_EQ(frames.size(), 3u);
    for (const Frame& frame : frames) {
      EXPECT_EQ(frame.file.empty(), !IsFile(codec));
      EXPECT_EQ(frame.radiance.empty(), !HoldsLayers(codec));
      if (codec == FrameCodec::kFloat || codec == FrameCodec::kExr) {
        EXPECT_EQ(frame.radiance, classical);
      }
      EXPECT_EQ(frame.radiance, frames[0].radiance);
      EXPECT_EQ(frame.stats.pixels, 600u);
    }
  }
}

}  // namespace
}  // namespace linetree
