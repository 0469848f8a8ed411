// Editing a scene that is being served.
#include <thread>

#include "tests/server/running_server.h"

namespace linetree {
namespace {

using testing::HasSubstr;

v1::UpdateSceneRequest Request(const std::string& edits) {
  v1::UpdateSceneRequest request;
  LT_CHECK(google::protobuf::TextFormat::ParseFromString(edits, &request));
  request.set_scene("ball");
  return request;
}

struct Answer {
  absl::Status status;
  v1::UpdateSceneReply reply;
};
Answer Update(test::RunningServer& running, const v1::UpdateSceneRequest& request) {
  grpc::ClientContext context;
  Answer answer;
  const auto status = running.stub().UpdateScene(&context, request, &answer.reply);
  answer.status =
      absl::Status(static_cast<absl::StatusCode>(status.error_code()), status.error_message());
  return answer;
}

Frame Rendered(Client& client, const std::string& scene, Mode mode) {
  FrameRequest request;
  request.width = request.height = 200;
  request.options.mode = mode;
  request.options.max_relative_error = 0;
  auto frame = client.RenderFrame(scene, request, "front", {.all_layers = true}, nullptr);
  EXPECT_TRUE(frame.ok()) << frame.status();
  return *std::move(frame);
}

constexpr char kMoveBall[] = R"(edits { move_object {
  object { name: "ball" } transform { translate { x: 0.5 } } } })";

TEST(UpdateSceneTest, EditedAndWarmAnswersAreThoseOfAFreshScene) {
  test::RunningServer running;
  Client& client = running.client();
  for (int frame = 0; frame < 3; ++frame) Rendered(client, "ball", Mode::kCached);
  const Answer answer = Update(running, Request(kMoveBall));
  ASSERT_TRUE(answer.status.ok()) << answer.status;

  v1::Scene moved = test::BallScene();
  moved.mutable_objects(0)->add_transform()->mutable_translate()->set_x(0.5);
  const auto fresh = client.LoadScene("fresh", moved, false);
  ASSERT_TRUE(fresh.ok()) << fresh.status();
  EXPECT_EQ(answer.reply.info().scene_version(), fresh->scene_version());
  const Frame classical = Rendered(client, "fresh", Mode::kClassical);
  for (int frame = 0; frame < 3; ++frame) {
    const Frame edited = Rendered(client, "ball", Mode::kCached);
    EXPECT_EQ(edited.radiance, classical.radiance);
    EXPECT_EQ(edited.object, classical.object);
    EXPECT_EQ(edited.scene_version, fresh->scene_version());
  }
}

// Cells of a kind of tree of the scene "ball".
uint64_t CellsOf(Client& client, const std::string& trees) {
  const auto stats = client.GetStats("ball");
  EXPECT_TRUE(stats.ok()) << stats.status();
  for (const auto& part : stats->scenes(0).memory()) {
    if (part.name() == trees) return part.cells();
  }
  ADD_FAILURE() << trees;
  return 0;
}

// Something small far away. No shadow ray comes near it, so all surface cells stay. Whether the
// ball mirrors it is not known: of the ball's cells those stay whose rays all end at the floor.
TEST(UpdateSceneTest, WhatTheEditsDoNotTouchIsKept) {
  test::RunningServer running;
  Client& client = running.client();
  for (int frame = 0; frame < 3; ++frame) Rendered(client, "ball", Mode::kCached);
  const uint64_t surface = CellsOf(client, "surface trees"), paths = CellsOf(client, "linetrees");
  ASSERT_GT(surface, 20u);
  const auto answer = Update(running, Request(R"(edits { add_object { name: "far" material: "matte"
    sphere { center { x: 900 y: -900 } radius: 0.1 } } })"));
  ASSERT_TRUE(answer.status.ok()) << answer.status;
  EXPECT_EQ(answer.reply.info().objects(), 3u);
  EXPECT_EQ(CellsOf(client, "surface trees"), surface);
  EXPECT_EQ(answer.reply.cells_kept(), surface + CellsOf(client, "linetrees"));
  EXPECT_EQ(answer.reply.cells_kept() + answer.reply.cells_dropped(), surface + paths);
  EXPECT_GT(CellsOf(client, "linetrees"), 0u);
  EXPECT_LT(CellsOf(client, "linetrees"), paths);
}

TEST(UpdateSceneTest, BadEditsChangeNothing) {
  test::RunningServer running;
  const auto expect_refused = [&](const v1::UpdateSceneRequest& request, absl::StatusCode code,
                                  const std::string& message) {
    const absl::Status status = Update(running, request).status;
    EXPECT_EQ(status.code(), code) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(message));
  };
  expect_refused(Request("edits { remove_object { index: 9 } }"),
                 absl::StatusCode::kInvalidArgument, "edits[0].remove_object.index");
  expect_refused(Request(R"(edits { set_material { object { index: 0 } material: "none" } })"),
                 absl::StatusCode::kInvalidArgument, "objects[0].material");
  auto request = Request(kMoveBall);
  request.set_expected_version("0123");
  expect_refused(request, absl::StatusCode::kFailedPrecondition, "expected_version");
  request.set_scene("nobody");
  expect_refused(request, absl::StatusCode::kNotFound, "scene:");
  EXPECT_EQ(running.client().DescribeScene("ball")->scene_version(),
            test::BuiltBallScene()->version);
}

TEST(UpdateSceneTest, MovesDoNotPileUp) {
  test::RunningServer running;
  const auto bytes = [&] {
    return running.server().backend().scenes().Find("ball", "")->content->size();
  };
  v1::Scene all_steps = test::BallScene();
  size_t after_one = 0;
  for (int move = 0; move < 100; ++move) {
    const std::string step = R"(rotate { axis { x: 1 y: 2 } angle_deg: 7.3 })";
    ASSERT_TRUE(
        Update(running, Request("edits { move_object { object { name: 'ball' } transform { " +
                                step + " } transform { translate { x: 0.001 } } } }"))
            .status.ok());
    for (const std::string& text : {step, std::string("translate { x: 0.001 }")}) {
      LT_CHECK(google::protobuf::TextFormat::ParseFromString(
          text, all_steps.mutable_objects(0)->add_transform()));
    }
    if (move == 0) after_one = bytes();
  }
  EXPECT_EQ(bytes(), after_one);
  const auto fresh = running.client().LoadScene("fresh", all_steps, false);
  ASSERT_TRUE(fresh.ok()) << fresh.status();
  EXPECT_EQ(running.client().DescribeScene("ball")->scene_version(), fresh->scene_version());
  EXPECT_EQ(Rendered(running.client(), "ball", Mode::kCached).radiance,
            Rendered(running.client(), "fresh", Mode::kClassical).radiance);
}

TEST(UpdateSceneTest, NoEditsKeepTheCache) {
  test::RunningServer running;
  Rendered(running.client(), "ball", Mode::kCached);
  auto request = Request("");
  request.set_expected_version(test::BuiltBallScene()->version);
  EXPECT_TRUE(Update(running, request).status.ok());
  EXPECT_EQ(running.client().GetStats("ball")->scenes(0).frames(), 1u);
}

// Each frame is all of one version.
TEST(UpdateSceneTest, FramesDuringEditsAreThoseOfTheVersionThatTheyName) {
  test::RunningServer running;
  std::map<std::string, Frame> classical;
  for (int step = 0; step < 6; ++step) {
    Frame frame = Rendered(running.client(), "ball", Mode::kClassical);
    classical.emplace(frame.scene_version, std::move(frame));
    ASSERT_TRUE(Update(running, Request(kMoveBall)).status.ok());
  }
  ASSERT_TRUE(running.client().LoadScene("ball", test::BallScene(), true).ok());
  std::thread editor([&] {
    for (int step = 0; step < 5; ++step) {
      Rendered(running.client(), "ball", Mode::kCached);  // so that edits fall between frames
      EXPECT_TRUE(Update(running, Request(kMoveBall)).status.ok());
    }
  });
  for (int i = 0; i < 12; ++i) {
    const Frame frame = Rendered(running.client(), "ball", Mode::kCached);
    const auto version = classical.find(frame.scene_version);
    ASSERT_NE(version, classical.end());
    EXPECT_EQ(frame.radiance, version->second.radiance);
  }
  editor.join();
}

}  // namespace
}  // namespace linetree
