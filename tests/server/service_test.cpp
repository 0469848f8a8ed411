// What the RPCs answer when all is well.
#include <chrono>
#include <cmath>
#include <thread>

#include "tests/server/running_server.h"

namespace linetree {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

FrameRequest RequestOf(const Camera& camera, int width, int height) {
  FrameRequest request;
  request.camera = camera;
  request.width = width;
  request.height = height;
  return request;
}

void ExpectSameFrame(const Frame& a, const Frame& b) {
  EXPECT_EQ(a.radiance, b.radiance);
  EXPECT_EQ(a.object, b.object);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.verdict, b.verdict);
  EXPECT_EQ(a.depth, b.depth);
  EXPECT_EQ(a.camera, b.camera);
  EXPECT_EQ(a.scene_version, b.scene_version);
  EXPECT_EQ(a.white, b.white);
  EXPECT_EQ(a.stats.interpolated, b.stats.interpolated);
  EXPECT_EQ(a.stats.cells_tried, b.stats.cells_tried);
  EXPECT_EQ(a.stats.base, b.stats.base);
  EXPECT_EQ(a.stats.ip, b.stats.ip);
}

std::vector<std::string> Names(const std::vector<v1::SceneInfo>& scenes) {
  std::vector<std::string> names;
  for (const auto& scene : scenes) names.push_back(scene.name());
  return names;
}

TEST(ServiceTest, ScenesComeAndGo) {
  test::RunningServer running;
  Client& client = running.client();
  const auto loaded = client.LoadScene("second", test::BallScene(), false);
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ(loaded->objects(), 2u);
  EXPECT_EQ(loaded->scene_version(), test::BuiltBallScene()->version);
  EXPECT_THAT(Names(*client.ListScenes()), ElementsAre("ball", "second"));
  EXPECT_EQ(client.DescribeScene("second")->cameras_size(), 2);
  EXPECT_TRUE(client.UnloadScene("second").ok());
  EXPECT_THAT(Names(*client.ListScenes()), ElementsAre("ball"));
  EXPECT_TRUE(absl::IsNotFound(client.DescribeScene("second").status()));
  EXPECT_TRUE(absl::IsNotFound(client.UnloadScene("second")));
}

TEST(ServiceTest, TheSameContentAgainKeepsTheWarmCache) {
  test::RunningServer running;
  running.ExpectServing();
  const auto again = running.client().LoadScene("ball", test::BallScene(), true);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(running.client().GetStats("ball")->scenes(0).frames(), 1u);
}

TEST(ServiceTest, OtherContentNeedsReplace) {
  test::RunningServer running;
  v1::Scene other = test::BallScene();
  other.mutable_objects(0)->mutable_sphere()->set_radius(0.5);
  const auto refused = running.client().LoadScene("ball", other, false);
  EXPECT_TRUE(absl::IsAlreadyExists(refused.status())) << refused.status();
  EXPECT_THAT(std::string(refused.status().message()), HasSubstr("name:"));
  const auto replaced = running.client().LoadScene("ball", other, true);
  ASSERT_TRUE(replaced.ok()) << replaced.status();
  EXPECT_NE(replaced->scene_version(), test::BuiltBallScene()->version);
  running.ExpectServing();
}

TEST(ServiceTest, AFailedLoadLeavesTheOldSceneAsItIs) {
  test::RunningServer running;
  running.ExpectServing();
  v1::LoadSceneRequest good;
  good.set_name("ball");
  good.set_replace(true);
  *good.mutable_scene() = test::BallScene();
  const auto load = [&](void (*spoil)(v1::LoadSceneRequest&)) {
    v1::LoadSceneRequest request = good;
    spoil(request);
    grpc::ClientContext context;
    v1::SceneInfo info;
    return running.stub().LoadScene(&context, request, &info);
  };
  using Request = v1::LoadSceneRequest;
  const std::vector<std::pair<const char*, void (*)(Request&)>> kBad = {
      {"objects[0].",
       [](Request& r) { r.mutable_scene()->mutable_objects(0)->mutable_sphere()->set_radius(-1); }},
      {"memory_weight:", [](Request& r) { r.set_memory_weight(0); }},
      {"file:", [](Request& r) { r.set_file("a.nff"); }},
      {"content:", [](Request& r) { r.clear_content(); }},
      {"warm_up.path: keyframes:", [](Request& r) { r.mutable_warm_up(); }},
      {"warm_up.width:",
       [](Request& r) {
         auto* key = r.mutable_warm_up()->mutable_path()->add_keyframes();
         key->mutable_camera()->mutable_eye()->set_z(1);
         r.mutable_warm_up()->set_width(1'000'000);
       }},
      {"warm_up.frames:", [](Request& r) {
         auto* key = r.mutable_warm_up()->mutable_path()->add_keyframes();
         key->mutable_camera()->mutable_eye()->set_z(1);
         r.mutable_warm_up()->set_frames(1001);
       }}};
  for (const auto& [field, spoil] : kBad) {
    const auto status = load(spoil);
    EXPECT_FALSE(status.ok()) << field;
    EXPECT_THAT(status.error_message(), testing::StartsWith(field));
  }
  running.ExpectServing();
  const auto stats = running.client().GetStats("ball");
  EXPECT_EQ(stats->scenes(0).frames(), 2u) << "the same host";
  EXPECT_EQ(stats->scenes(0).scene_version(), test::BuiltBallScene()->version);
}

TEST(ServiceTest, AFrameIsTheHostsFrame) {
  test::RunningServer running;
  SceneHost host(test::BuiltBallScene());
  WorkerPool pool(1);
  const Camera& camera = host.scene().cameras[1];
  for (int warmth = 0; warmth < 2; ++warmth) {
    const FrameRequest request = RequestOf(camera, 100, 70);
    double share = 0;
    const auto served = running.client().RenderFrame("ball", request, "", {.all_layers = true},
                                                     [&](double done) { share = done; });
    ASSERT_TRUE(served.ok()) << served.status();
    ExpectSameFrame(*served, *host.RenderFrame(request, pool));
    EXPECT_EQ(share, 1);
    EXPECT_EQ(served->stats.interpolated + served->stats.traced + served->stats.background, 7000u);
  }
}

TEST(ServiceTest, ANamedCameraIsTheScenes) {
  test::RunningServer running;
  const auto frame = running.client().RenderFrame("ball", RequestOf({}, 8, 8), "left", {}, nullptr);
  ASSERT_TRUE(frame.ok()) << frame.status();
  EXPECT_EQ(frame->camera, test::BuiltBallScene()->cameras[1]);
  EXPECT_TRUE(frame->depth.empty());
}

TEST(ServiceTest, WhatARequestLeavesOutIsTheServersDefault) {
  ServerOptions options;
  options.defaults.max_relative_error = 0.625;
  test::RunningServer running(options);
  grpc::ClientContext context;
  const auto stream = running.stub().RenderFrame(&context, test::SmallFrame());
  v1::FrameChunk chunk;
  while (stream->Read(&chunk)) {
  }
  ASSERT_TRUE(stream->Finish().ok());
  EXPECT_EQ(chunk.end().max_relative_error(), 0.625);
  EXPECT_EQ(chunk.end().camera().name(), "front");
}

TEST(ServiceTest, AFlightsFramesComeInOrderAndAreTheHosts) {
  ServerOptions options;
  options.prefetch = false;  // its caches learn what the host's learn
  test::RunningServer running(options);
  SceneHost host(test::BuiltBallScene());
  WorkerPool pool(1);
  std::vector<FrameRequest> requests;
  for (int i = 0; i < 20; ++i) {
    Camera camera = host.scene().cameras[0];
    camera.eye.x = 0.1 * i;
    requests.push_back(RequestOf(camera, 40 + i, 30));
  }
  size_t expected = 0;
  const auto status = running.client().Fly(
      "ball", requests, {.all_layers = true}, [&](size_t index, const Frame& frame) {
        EXPECT_EQ(index, expected++);
        ExpectSameFrame(frame, *host.RenderFrame(requests[index], pool));
      });
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_EQ(expected, 20u);
}

TEST(ServiceTest, AFlightMaySendFarAhead) {
  test::RunningServer running;
  constexpr uint64_t kViewpoints = 300;  // several times what the server holds
  grpc::ClientContext context;
  const auto stream = running.stub().Fly(&context);
  std::thread writer([&] {
    for (uint64_t i = 0; i < kViewpoints; ++i) {
      v1::FlyRequest request;
      request.set_sequence(1000 + i);
      *request.mutable_frame() = test::SmallFrame();
      EXPECT_TRUE(stream->Write(request));
    }
    stream->WritesDone();
  });
  uint64_t ends = 0;
  v1::FlyReply reply;
  while (stream->Read(&reply)) {
    EXPECT_EQ(reply.sequence(), 1000 + ends);
    if (reply.chunk().has_end()) ++ends;
  }
  writer.join();
  EXPECT_TRUE(stream->Finish().ok());
  EXPECT_EQ(ends, kViewpoints);
}

TEST(ServiceTest, RaysAreTheHostsRays) {
  test::RunningServer running;
  SceneHost host(test::BuiltBallScene());
  WorkerPool pool(1);
  std::vector<Ray> rays;
  for (int i = 0; i < 500; ++i) rays.push_back({{0.01 * i - 2, 3, 8}, {0, -0.5, -2}});
  const auto served = running.client().TraceRays("ball", rays, RenderOptions());
  ASSERT_TRUE(served.ok()) << served.status();
  const auto local = host.TraceRays(rays, RenderOptions(), pool);
  ASSERT_EQ(served->answers.size(), rays.size());
  for (size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(served->answers[i].radiance, local->answers[i].radiance);
    EXPECT_EQ(served->answers[i].depth, local->answers[i].depth);
    EXPECT_EQ(served->answers[i].object, local->answers[i].object);
  }
  EXPECT_EQ(served->stats.pixels, rays.size());
}

// The parts of a frame's or batch's time lie within what passed here, and say that it was worked
// on.
void ExpectWithin(const v1::FrameTiming& timing, double wall_ms, double elapsed_ms) {
  EXPECT_GE(timing.queue_ms(), 0);
  EXPECT_GE(timing.render_ms(), wall_ms);
  EXPECT_GT(timing.render_ms(), 0);
  EXPECT_GT(timing.encode_ms(), 0);
  EXPECT_LE(timing.queue_ms() + timing.render_ms() + timing.encode_ms(), elapsed_ms);
}

TEST(ServiceTest, RepliesSayWhereTheirTimeWent) {
  test::RunningServer running;
  const auto began = std::chrono::steady_clock::now();
  const auto elapsed_ms = [began] {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began)
        .count();
  };
  for (const v1::Codec codec : {v1::CODEC_FLOAT, v1::CODEC_PNG}) {
    grpc::ClientContext context;
    v1::RenderFrameRequest request = test::SmallFrame(100, 100);
    request.set_codec(codec);
    const auto stream = running.stub().RenderFrame(&context, request);
    v1::FrameChunk chunk;
    while (stream->Read(&chunk)) continue;
    ASSERT_TRUE(stream->Finish().ok());
    ExpectWithin(chunk.end().timing(), chunk.end().stats().wall_ms(), elapsed_ms());
  }
  grpc::ClientContext flight_context;
  const auto flight = running.stub().Fly(&flight_context);
  v1::FlyRequest viewpoint;
  *viewpoint.mutable_frame() = test::SmallFrame(100, 100);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(flight->Write(viewpoint));
  flight->WritesDone();
  v1::FlyReply reply;
  double sum_ms = 0;  // no part of a flight's time belongs to two frames
  while (flight->Read(&reply)) {
    if (!reply.chunk().has_end()) continue;
    const v1::FrameTiming& timing = reply.chunk().end().timing();
    ExpectWithin(timing, reply.chunk().end().stats().wall_ms(), elapsed_ms());
    sum_ms += timing.queue_ms() + timing.render_ms() + timing.encode_ms();
  }
  EXPECT_LE(sum_ms, elapsed_ms());
  EXPECT_TRUE(flight->Finish().ok());

  grpc::ClientContext rays_context;
  v1::TraceRaysRequest rays;
  rays.set_scene("ball");
  for (int i = 0; i < 100; ++i) {
    rays.add_rays()->mutable_origin()->set_y(3);
    rays.mutable_rays(i)->mutable_direction()->set_y(-1);
  }
  v1::TraceRaysReply answers;
  ASSERT_TRUE(running.stub().TraceRays(&rays_context, rays, &answers).ok());
  ExpectWithin(answers.timing(), answers.stats().wall_ms(), elapsed_ms());
}

TEST(ServiceTest, ManyClientsAtOnceGetTheirOwnPictures) {
  test::RunningServer running;
  SceneHost host(test::BuiltBallScene());
  WorkerPool pool(1);
  std::vector<std::thread> clients;
  for (int c = 0; c < 4; ++c) {
    FrameRequest request = RequestOf(host.scene().cameras[0], 60, 40);
    request.camera.eye.x = c;
    request.options.mode = c % 2 == 0 ? Mode::kClassical : Mode::kCached;
    request.options.max_relative_error = 0.05;
    FrameRequest classical = request;
    classical.options.mode = Mode::kClassical;
    const auto reference = host.RenderFrame(classical, pool);
    ASSERT_TRUE(reference.ok());
    clients.emplace_back([&running, request, reference = *reference] {
      const auto client = running.NewClient();
      for (int round = 0; round < 8; ++round) {
        const auto frame = client->RenderFrame("ball", request, "", {.all_layers = true}, nullptr);
        ASSERT_TRUE(frame.ok()) << frame.status();
        EXPECT_EQ(frame->object, reference.object);
        if (request.options.mode == Mode::kClassical) {
          EXPECT_EQ(frame->radiance, reference.radiance);
        }
        EXPECT_EQ(frame->stats.interpolated + frame->stats.traced + frame->stats.background, 2400u);
      }
    });
  }
  for (auto& client : clients) client.join();
  const auto stats = running.client().GetStats("ball");
  ASSERT_TRUE(stats.ok()) << stats.status();
  EXPECT_EQ(stats->scenes(0).frames(), 32u);
  EXPECT_EQ(stats->scenes(0).totals().pixels(), 32u * 2400u);
}

TEST(ServiceTest, StatisticsOfOneSceneOrAll) {
  test::RunningServer running;
  running.ExpectServing();
  ASSERT_TRUE(running.client().LoadScene("second", test::BallScene(), false).ok());
  const auto all = running.client().GetStats("");
  ASSERT_TRUE(all.ok()) << all.status();
  ASSERT_EQ(all->scenes_size(), 2);
  EXPECT_EQ(all->scenes(0).frames(), 1u);
  EXPECT_EQ(all->scenes(1).frames(), 0u);
  EXPECT_EQ(all->memory_budget_bytes(), ServerOptions().memory_bytes);
  EXPECT_FALSE(all->server_version().empty());
  EXPECT_EQ(running.client().GetStats("second")->scenes_size(), 1);
}

TEST(ServiceTest, TextErrorsSayLineAndColumn) {
  test::RunningServer running;
  v1::LoadSceneRequest request;
  request.set_name("broken");
  request.set_text("name: \"x\"\nobjects { sphere { radius: oops } }\n");
  grpc::ClientContext context;
  v1::SceneInfo info;
  const auto status = running.stub().LoadScene(&context, request, &info);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("broken:2:"));
}

TEST(ServiceTest, NffTextIsUnderstood) {
  test::RunningServer running;
  v1::LoadSceneRequest request;
  request.set_name("nff");
  request.set_format(v1::LoadSceneRequest::NFF);
  request.set_text(
      "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\nresolution 64 64\n"
      "l 3 4 5\nf 1 0 0 0.7 0.3 10 0 0\ns 0 0 0 1\n");
  grpc::ClientContext context;
  v1::SceneInfo info;
  const auto status = running.stub().LoadScene(&context, request, &info);
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(info.objects(), 1u);
}

}  // namespace
}  // namespace linetree
