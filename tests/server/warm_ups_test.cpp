#include "server/warm_ups.h"

#include <gtest/gtest.h>

#include <future>

#include "tests/support/demo_scenes.h"

namespace linetree {
namespace {

class WarmUpsTest : public testing::Test {
 protected:
  WarmUpsTest()
      : scene_{"a", std::make_shared<SceneHost>(test::BallsOnFloor(3, 1), CacheOptions{}), {}} {
    small_.camera = scene_.host->scene().cameras[0];
    small_.width = small_.height = 40;
    large_ = small_;
    large_.width = large_.height = 4000;
    large_.options.mode = Mode::kClassical;
  }
  ~WarmUpsTest() override { warm_ups_.Stop(); }

  // Starts it; the future is ready at its end.
  std::future<void> Start(const std::vector<FrameRequest>& frames) {
    const auto done = std::make_shared<std::promise<void>>();
    warm_ups_.Start(scene_, frames, [done] { done->set_value(); });
    return done->get_future();
  }

  NamedHost scene_;
  FrameRequest small_, large_;
  WorkerPool pool_{2};
  JobQueue queue_{1, {}, absl::ResourceExhaustedError("busy")};
  WarmUps warm_ups_{queue_, pool_};
};

TEST_F(WarmUpsTest, AllFramesAreRenderedAndTheCachesLearn) {
  Start({small_, small_, small_}).wait();
  EXPECT_EQ(scene_.host->totals().frames, 3u);
  EXPECT_GT(scene_.host->CacheBytes(), 0u);
  EXPECT_EQ(warm_ups_.FramesLeft("a"), 0u);
}

TEST_F(WarmUpsTest, CallersGoFirst) {
  // Of two jobs of a caller that come later, both are done before the second frame.
  std::promise<void> begun, open;
  EXPECT_TRUE(queue_
                  .Submit({},
                          [&](const absl::Status&) {
                            begun.set_value();
                            open.get_future().wait();
                          })
                  .ok());
  begun.get_future().wait();
  auto end = Start({small_, small_});
  EXPECT_EQ(warm_ups_.FramesLeft("a"), 2u);
  std::promise<uint64_t> seen;
  EXPECT_TRUE(
      queue_
          .Submit({.session = "caller"},
                  [&](const absl::Status&) { seen.set_value(scene_.host->totals().frames); })
          .ok());
  open.set_value();
  EXPECT_EQ(seen.get_future().get(), 0u);
  end.wait();
}

TEST_F(WarmUpsTest, AnotherOneTakesItsPlace) {
  auto first = Start({large_, large_});
  auto second = Start({small_});
  first.wait();
  second.wait();
  EXPECT_EQ(scene_.host->totals().frames, 1u);
}

TEST_F(WarmUpsTest, ItEndsWithItsScene) {
  std::weak_ptr<SceneHost> host = scene_.host;
  auto end = Start(std::vector<FrameRequest>(100'000, small_));
  scene_.host.reset();
  end.wait();
  EXPECT_TRUE(host.expired());
}

TEST_F(WarmUpsTest, StoppingGivesAllUp) {
  auto end = Start({large_, large_, large_});
  warm_ups_.Stop();
  EXPECT_EQ(scene_.host->totals().frames, 0u);
  EXPECT_EQ(end.wait_for(std::chrono::seconds(0)), std::future_status::ready) << "not called";
  warm_ups_.Start(scene_, {small_});
  EXPECT_EQ(warm_ups_.FramesLeft("a"), 0u);
}

}  // namespace
}  // namespace linetree
