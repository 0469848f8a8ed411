// linetreed --audit: answers are traced again, counted, and violations logged.
#include <spdlog/sinks/ostream_sink.h>

#include <sstream>

#include "tests/server/running_server.h"

namespace linetree {
namespace {

using testing::HasSubstr;

class AuditedServer {
 public:
  explicit AuditedServer(size_t max_waiting = 100'000) : running_(Options(max_waiting), Log()) {}

  test::RunningServer& running() { return running_; }
  Backend& backend() { return running_.server().backend(); }
  LiveScene Ball() {
    const auto scene = backend().scenes().Find("ball", "scene");
    LT_CHECK(scene.ok());
    return {scene->name, scene->host, scene->audit};
  }
  v1::GetStatsReply::AuditStats Stats() {
    backend().audit().WaitUntilChecked();
    return running_.client().GetStats("ball")->scenes(0).audit();
  }
  // What was logged. Only when the audit is idle.
  std::string logged() const { return text_.str(); }

  Frame Render(Mode mode) {
    FrameRequest request;
    request.width = request.height = 32;
    request.options.mode = mode;
    request.options.judge = JudgeKind::kCertified;
    const auto frame = running_.client().RenderFrame("ball", request, "front", {}, nullptr);
    EXPECT_TRUE(frame.ok()) << frame.status();
    return *frame;
  }

 private:
  static ServerOptions Options(size_t max_waiting) {
    ServerOptions options;
    options.audit_share = 1;
    options.limits.max_waiting_audits = max_waiting;
    return options;
  }
  std::shared_ptr<spdlog::logger> Log() {
    return std::make_shared<spdlog::logger>(
        "audit", std::make_shared<spdlog::sinks::ostream_sink_mt>(text_));
  }

  std::ostringstream text_;  // before the server, whose threads write to it
  test::RunningServer running_;
};

// An answer that no ray has, along one that meets the ball.
void PlantViolation(AuditedServer& server) {
  RayBatch batch;
  batch.answers.resize(1);
  batch.answers[0].radiance = {9, 9, 9};
  server.backend().audit().Offer(server.Ball(), {{{0, 1, 9}, {0, 0, -2}}}, {}, batch);
}

TEST(AuditOfAnswersTest, EveryCachedAnswerIsCheckedAndCounted) {
  AuditedServer server;
  server.Render(Mode::kCached);
  EXPECT_EQ(server.Stats().checked(), 1024u);
  server.Render(Mode::kClassical);
  EXPECT_EQ(server.Stats().checked(), 1024u);
  const auto batch = server.running().client().TraceRays(
      "ball", {{{0, 1, 9}, {0, 0, -3}}, {{0, 1, 9}, {0, 5, -3}}}, RenderOptions());
  ASSERT_TRUE(batch.ok()) << batch.status();
  const auto stats = server.Stats();
  EXPECT_EQ(stats.checked(), 1026u);
  EXPECT_EQ(stats.violations() + stats.dropped(), 0u);
  EXPECT_EQ(server.running().client().GetStats("")->audit_share(), 1);
}

TEST(AuditOfAnswersTest, FlightsAreAuditedToo) {
  AuditedServer server;
  FrameRequest request;
  request.camera = test::BuiltBallScene()->cameras[0];
  request.width = request.height = 20;
  const auto status =
      server.running().client().Fly("ball", {request, request}, {}, [](size_t, const Frame&) {});
  ASSERT_TRUE(status.ok()) << status;
  EXPECT_EQ(server.Stats().checked(), 800u);
}

TEST(AuditOfAnswersTest, APlantedViolationIsInStatsAndLog) {
  AuditedServer server;
  PlantViolation(server);
  const auto stats = server.Stats();
  EXPECT_EQ(stats.checked(), 1u);
  EXPECT_EQ(stats.violations(), 1u);
  EXPECT_GT(stats.max_error_over_allowed(), 1);
  EXPECT_THAT(server.logged(), HasSubstr("audit: an answer breaks its promise: scene=\"ball " +
                                         test::BuiltBallScene()->version +
                                         "\" origin=0x0p+0,0x1p+0,0x1.2p+3 "
                                         "direction=0x0p+0,0x0p+0,-0x1p+1 epsilon=0.1"));
}

TEST(AuditOfAnswersTest, AReplacedSceneStartsFromZero) {
  AuditedServer server;
  server.Render(Mode::kCached);
  v1::Scene other = test::BallScene();
  other.mutable_objects(0)->mutable_sphere()->set_radius(0.5);
  ASSERT_TRUE(server.running().client().LoadScene("ball", other, true).ok());
  EXPECT_EQ(server.Stats().checked(), 0u);
  server.Render(Mode::kCached);
  ASSERT_TRUE(server.running().client().UnloadScene("ball").ok());
  server.backend().audit().WaitUntilChecked();
}

TEST(AuditOfAnswersTest, AServerStopsWithWorkInTheQueue) {
  AuditedServer server;
  for (int i = 0; i < 20; ++i) server.Render(Mode::kCached);
  ASSERT_TRUE(server.running().client().UnloadScene("ball").ok());
}

TEST(AuditOfAnswersTest, WhatFindsNoRoomIsCounted) {
  AuditedServer server(/*max_waiting=*/1);
  for (int i = 0; i < 5; ++i) server.Render(Mode::kCached);
  const auto stats = server.Stats();
  EXPECT_EQ(stats.checked() + stats.dropped(), 5u * 1024);
  EXPECT_GT(stats.dropped(), 0u);
}

TEST(AuditOfAnswersTest, NothingIsAuditedUnlessAskedFor) {
  test::RunningServer running;
  running.ExpectServing();
  running.server().backend().audit().WaitUntilChecked();
  const auto stats = running.client().GetStats("ball");
  EXPECT_EQ(stats->audit_share(), 0);
  EXPECT_EQ(stats->scenes(0).audit().checked(), 0u);
}

}  // namespace
}  // namespace linetree
