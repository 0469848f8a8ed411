#include "client/command/local_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/io/load_scene.h"
#include "core/io/wire.h"

namespace linetree {
namespace {

v1::Scene ReadMessage(const std::string& name) {
  auto source = ReadSceneFile(std::string(LINETREE_SOURCE_DIR) + "/scenes/" + name);
  EXPECT_EQ(source.status(), absl::OkStatus());
  return (*source)->message();
}

class LocalClientTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto info = client_.LoadScene("gap", ReadMessage("gap.textproto"), false);
    ASSERT_EQ(info.status(), absl::OkStatus());
    request_ = {CameraFromWire(info->cameras(0)), 32, 24, {}};
  }

  LocalClient client_{2, uint64_t{64} << 20};
  FrameRequest request_;
};

TEST_F(LocalClientTest, LayersComeWhenAskedFor) {
  const auto plain = client_.RenderFrame("gap", request_, "", {}, nullptr);
  ASSERT_EQ(plain.status(), absl::OkStatus());
  EXPECT_EQ(plain->radiance.size(), 3u * 32 * 24);
  EXPECT_TRUE(plain->depth.empty());
  EXPECT_EQ(client_.RenderFrame("gap", request_, "", {.all_layers = true}, nullptr)->depth.size(),
            32u * 24);
}

TEST_F(LocalClientTest, CamerasByName) {
  const FrameRequest unnamed{{}, 8, 8, {}};
  const auto frame = client_.RenderFrame("gap", unnamed, "front", {}, nullptr);
  ASSERT_EQ(frame.status(), absl::OkStatus());
  EXPECT_EQ(frame->camera.name, "front");
  EXPECT_EQ(client_.RenderFrame("gap", request_, "back", {}, nullptr).status().code(),
            absl::StatusCode::kNotFound);
}

TEST_F(LocalClientTest, FliesInOrder) {
  std::vector<size_t> order;
  const absl::Status status = client_.Fly("gap", {request_, request_, request_}, {},
                                          [&](size_t i, Frame) { order.push_back(i); });
  EXPECT_EQ(status, absl::OkStatus());
  EXPECT_THAT(order, ::testing::ElementsAre(0, 1, 2));
}

TEST_F(LocalClientTest, ScenesAreKeptReplacedAndForgotten) {
  EXPECT_EQ(client_.LoadScene("gap", ReadMessage("gap.textproto"), false).status(),
            absl::OkStatus());
  EXPECT_EQ(client_.LoadScene("gap", ReadMessage("peak.textproto"), false).status().code(),
            absl::StatusCode::kAlreadyExists);
  const auto replaced = client_.LoadScene("gap", ReadMessage("peak.textproto"), true);
  ASSERT_EQ(replaced.status(), absl::OkStatus());
  EXPECT_EQ(client_.DescribeScene("gap")->scene_version(), replaced->scene_version());
  EXPECT_EQ(client_.ListScenes()->size(), 1u);
  EXPECT_EQ(client_.UnloadScene("gap"), absl::OkStatus());
  EXPECT_EQ(client_.UnloadScene("gap").code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(client_.RenderFrame("gap", request_, "", {}, nullptr).status().code(),
            absl::StatusCode::kNotFound);
}

TEST_F(LocalClientTest, StatisticsCountWhatWasDone) {
  ASSERT_TRUE(client_.RenderFrame("gap", request_, "", {}, nullptr).ok());
  const std::vector<Ray> rays(5, Ray{{0, 1, 5}, {0, 0, -1}});
  ASSERT_TRUE(client_.TraceRays("gap", rays, {}).ok());
  const auto stats = client_.GetStats("");
  ASSERT_EQ(stats.status(), absl::OkStatus());
  ASSERT_EQ(stats->scenes_size(), 1);
  EXPECT_EQ(stats->scenes(0).frames(), 1u);
  EXPECT_EQ(stats->scenes(0).ray_batches(), 1u);
  EXPECT_EQ(stats->scenes(0).totals().pixels(), 32u * 24 + 5);
  EXPECT_GT(stats->scenes(0).cells(), 0u);
  EXPECT_EQ(client_.GetStats("none").status().code(), absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace linetree
