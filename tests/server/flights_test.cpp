// What a flight may ask for: pacing, lesser frames while it moves, going on in another stream.
#include <atomic>
#include <thread>

#include "tests/server/running_server.h"

namespace linetree {
namespace {

using FlyStream = grpc::ClientReaderWriter<v1::FlyRequest, v1::FlyReply>;

v1::FlyRequest Viewpoint(uint64_t sequence, const v1::RenderFrameRequest& frame) {
  v1::FlyRequest request;
  request.set_sequence(sequence);
  *request.mutable_frame() = frame;
  return request;
}

// The replies of one frame, or of the end.
std::vector<v1::FlyReply> ReadFrame(FlyStream& stream) {
  std::vector<v1::FlyReply> replies;
  v1::FlyReply reply;
  while (stream.Read(&reply)) {
    replies.push_back(reply);
    if (reply.chunk().has_end()) break;
  }
  return replies;
}

Frame Assembled(const std::vector<v1::FlyReply>& replies, int width, int height) {
  FrameAssembler assembler(width, height, {});
  for (const auto& reply : replies) {
    EXPECT_TRUE(assembler.Add(reply.chunk()).ok());
  }
  EXPECT_TRUE(assembler.complete());
  return assembler.Take();
}

uint64_t FramesRendered(test::RunningServer& running) {
  return running.server().backend().GetStats({})->scenes(0).frames();
}

uint64_t CacheBytes(test::RunningServer& running) {
  return running.server().backend().GetStats({})->scenes(0).cache_bytes();
}

TEST(FlightsTest, TheNewestViewpointOvertakesThoseThatWait) {
  test::RunningServer running;
  grpc::ClientContext context;
  const auto stream = running.stub().Fly(&context);
  std::atomic<bool> seen_skips = false;
  uint64_t sent = 0;
  std::thread writer([&] {
    v1::FlyRequest request = Viewpoint(0, test::SmallFrame());
    request.set_pacing(v1::PACING_NEWEST);
    for (; !seen_skips; ++sent) {
      request.set_sequence(sent);
      EXPECT_TRUE(stream->Write(request));
    }
    stream->WritesDone();
  });
  uint64_t frames = 0, skipped = 0, last = 0;
  for (auto replies = ReadFrame(*stream); !replies.empty(); replies = ReadFrame(*stream)) {
    const v1::FlyReply& end = replies.back();
    EXPECT_EQ(end.frame_number(), ++frames);
    EXPECT_TRUE(frames == 1 || end.sequence() > last);
    last = end.sequence();
    skipped += end.skipped();
    if (skipped > 0) seen_skips = true;
  }
  writer.join();
  EXPECT_TRUE(stream->Finish().ok());
  EXPECT_EQ(frames + skipped, sent);
  EXPECT_EQ(last + 1, sent) << "the newest one always gets its frame";
  EXPECT_EQ(FramesRendered(running), frames);
}

TEST(FlightsTest, AFrameIsReducedFirstAndFullAtRest) {
  test::RunningServer running;
  v1::RenderFrameRequest frame = test::SmallFrame(70, 40);
  frame.mutable_options()->set_mode(v1::CLASSICAL);
  grpc::ClientContext context;
  const auto stream = running.stub().Fly(&context);
  v1::FlyRequest request = Viewpoint(5, frame);
  request.mutable_while_moving()->set_divisor(4);
  EXPECT_TRUE(stream->Write(request));
  stream->WritesDone();
  const auto reduced = ReadFrame(*stream), full = ReadFrame(*stream);
  ASSERT_FALSE(full.empty());
  EXPECT_TRUE(reduced[0].reduced());
  EXPECT_FALSE(full[0].reduced());
  EXPECT_EQ(full[0].sequence(), 5u);
  EXPECT_EQ(full[0].frame_number(), 2u);
  EXPECT_EQ(reduced.back().chunk().end().stats().width(), 18u);
  SceneHost host(test::BuiltBallScene());
  WorkerPool pool(1);
  FrameRequest local;
  local.camera = host.scene().cameras[0];
  local.width = 70;
  local.height = 40;
  local.options.mode = Mode::kClassical;
  EXPECT_EQ(Assembled(full, 70, 40).radiance, host.RenderFrame(local, pool)->radiance);
  local.width = 18;
  local.height = 10;
  EXPECT_EQ(Assembled(reduced, 18, 10).radiance, host.RenderFrame(local, pool)->radiance);
  EXPECT_TRUE(ReadFrame(*stream).empty());
  EXPECT_TRUE(stream->Finish().ok());
}

TEST(FlightsTest, AFullFrameIsGivenUpForANewerViewpoint) {
  test::RunningServer running;
  grpc::ClientContext context;
  const auto stream = running.stub().Fly(&context);
  v1::FlyRequest request = Viewpoint(0, test::EndlessFrame());
  request.mutable_frame()->mutable_options()->set_mode(v1::CACHED);
  request.mutable_while_moving()->set_divisor(64);
  EXPECT_TRUE(stream->Write(request));
  EXPECT_TRUE(ReadFrame(*stream).at(0).reduced());
  const uint64_t reduced_bytes = CacheBytes(running);
  while (CacheBytes(running) == reduced_bytes && FramesRendered(running) < 2) {  // not begun
  }
  EXPECT_TRUE(stream->Write(Viewpoint(1, test::SmallFrame())));
  EXPECT_EQ(ReadFrame(*stream).at(0).sequence(), 1u);
  stream->WritesDone();
  EXPECT_TRUE(ReadFrame(*stream).empty());
  EXPECT_TRUE(stream->Finish().ok());
  EXPECT_EQ(FramesRendered(running), 2u) << "the endless one is not among them";
}

TEST(FlightsTest, AnOldFlightGoesOnInANewStream) {
  ServerOptions options;
  options.max_flight_s = std::chrono::seconds(1);
  test::RunningServer running(options);
  v1::FlyRequest request = Viewpoint(3, test::SmallFrame());
  for (uint64_t round = 0; round < 2; ++round) {
    grpc::ClientContext context;
    const auto stream = running.stub().Fly(&context);
    EXPECT_TRUE(stream->Write(request));
    EXPECT_EQ(ReadFrame(*stream).back().frame_number(), round + 1);
    v1::FlyReply last;
    ASSERT_TRUE(stream->Read(&last));
    EXPECT_EQ(last.frame_number(), round + 1);
    request.set_resume_token(last.farewell().resume_token());
    EXPECT_FALSE(stream->Read(&last));
    const auto status = stream->Finish();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAVAILABLE) << status.error_message();
  }
  request.set_resume_token("made up");
  grpc::ClientContext context;
  const auto stream = running.stub().Fly(&context);
  EXPECT_TRUE(stream->Write(request));
  const auto status = stream->Finish();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), testing::StartsWith("resume_token:"));
}

TEST(FlightsTest, EveryReplyCarriesTheRequestsId) {
  test::RunningServer running;
  for (const std::string& id : {std::string("mine-7"), std::string(500, 'x')}) {
    grpc::ClientContext frame_context, fly_context, rays_context;
    for (auto* context : {&frame_context, &fly_context, &rays_context}) {
      context->AddMetadata("x-request-id", id);
    }
    const auto id_sent_back = [](const grpc::ClientContext& context) {
      const auto& metadata = context.GetServerInitialMetadata();
      const auto found = metadata.find("x-request-id");
      EXPECT_NE(found, metadata.end());
      return std::string(found->second.data(), found->second.size());
    };
    const auto frame = running.stub().RenderFrame(&frame_context, test::SmallFrame());
    v1::FrameChunk chunk;
    while (frame->Read(&chunk)) {
    }
    EXPECT_EQ(chunk.end().request_id(), id_sent_back(frame_context));
    const auto flight = running.stub().Fly(&fly_context);
    EXPECT_TRUE(flight->Write(Viewpoint(0, test::SmallFrame())));
    const v1::FlyReply flown = ReadFrame(*flight).back();
    EXPECT_EQ(flown.chunk().end().request_id(), id_sent_back(fly_context));
    flight->WritesDone();
    EXPECT_TRUE(flight->Finish().ok());
    v1::TraceRaysRequest rays;
    rays.set_scene("ball");
    rays.add_rays()->mutable_direction()->set_z(-1);
    v1::TraceRaysReply reply;
    ASSERT_TRUE(running.stub().TraceRays(&rays_context, rays, &reply).ok());
    EXPECT_EQ(reply.request_id(), id_sent_back(rays_context));
    EXPECT_EQ(reply.max_relative_error(), RenderOptions().max_relative_error);
    if (id.size() < 100) {
      EXPECT_EQ(reply.request_id(), id);
    } else {
      EXPECT_EQ(reply.request_id().size(), 32u) << "made up: no such id is taken";
    }
  }
}

}  // namespace
}  // namespace linetree
