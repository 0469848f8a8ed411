// Calls that end early, from either side: nothing hangs, nothing is lost, others go on.
#include <atomic>
#include <thread>

#include "client/library/status.h"
#include "tests/server/running_server.h"

namespace linetree {
namespace {

using grpc::StatusCode;
using std::chrono::milliseconds;

constexpr milliseconds kAsLongAsItTakes{600'000};

v1::FlyRequest Viewpoint(uint64_t sequence) {
  v1::FlyRequest request;
  request.set_sequence(sequence);
  *request.mutable_frame() = test::SmallFrame();
  return request;
}

// Reads one whole frame of a flight.
template <class Stream>
bool ReadFrame(Stream& stream) {
  v1::FlyReply reply;
  while (stream.Read(&reply)) {
    if (reply.chunk().has_end()) return true;
  }
  return false;
}

uint64_t FramesRendered(test::RunningServer& running) {
  return running.server().backend().GetStats({})->scenes(0).frames();
}

TEST(EndingsTest, ACancelledFrameIsNotRenderedToItsEnd) {
  test::RunningServer running;
  grpc::ClientContext context;
  const auto stream = running.stub().RenderFrame(&context, test::EndlessFrame());
  running.ExpectServing();
  context.TryCancel();
  EXPECT_EQ(stream->Finish().error_code(), StatusCode::CANCELLED);
  running.server().Drain(kAsLongAsItTakes);
  EXPECT_EQ(FramesRendered(running), 1u) << "the small one only";
}

TEST(EndingsTest, ADeadlineStopsTheRendering) {
  test::RunningServer running;
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + milliseconds(50));
  const auto stream = running.stub().RenderFrame(&context, test::EndlessFrame());
  EXPECT_EQ(stream->Finish().error_code(), StatusCode::DEADLINE_EXCEEDED);
  running.server().Drain(kAsLongAsItTakes);
  EXPECT_EQ(FramesRendered(running), 0u);
}

TEST(EndingsTest, ACancelledBatchOfRaysIsGivenUp) {
  test::RunningServer running;
  v1::TraceRaysRequest request;
  request.set_scene("ball");
  v1::TraceRaysReply reply;
  for (int i = 0; i < 1 << 18; ++i) request.add_rays()->mutable_direction()->set_z(-1);
  grpc::ClientContext context;
  std::thread caller([&] {
    const auto status = running.stub().TraceRays(&context, request, &reply);
    // Cancelled, or so fast that it was done before.
    EXPECT_TRUE(status.ok() || status.error_code() == StatusCode::CANCELLED);
  });
  running.ExpectServing();
  context.TryCancel();
  caller.join();
  running.ExpectServing();
}

TEST(EndingsTest, AReaderThatGoesAwayGivesItsMemoryBack) {
  ServerOptions options;
  options.limits.max_frame_bytes = uint64_t{1000} * 1000 * kFrameBytesPerPixel;  // one such frame
  test::RunningServer running(options);
  for (int round = 0; round < 3; ++round) {
    grpc::ClientContext context;
    const auto stream = running.stub().RenderFrame(&context, test::SmallFrame(1000, 1000));
    v1::FrameChunk chunk;
    ASSERT_TRUE(stream->Read(&chunk)) << "round " << round;
    context.TryCancel();
    while (stream->Read(&chunk)) {
    }
    EXPECT_EQ(stream->Finish().error_code(), StatusCode::CANCELLED);
    // The client's retries give the server time to notice.
    FrameRequest whole;
    whole.width = whole.height = 1000;
    const auto frame = running.NewClient({.retry = {.max_attempts = 5}})
                           ->RenderFrame("ball", whole, "front", {}, nullptr);
    EXPECT_TRUE(frame.ok()) << frame.status();
  }
}

TEST(EndingsTest, AReaderThatTakesNothingDoesNotKeepItsMemoryForEver) {
  ServerOptions options;
  options.limits.max_frame_bytes = uint64_t{1000} * 1000 * kFrameBytesPerPixel;  // one such frame
  options.max_stall_s = std::chrono::seconds(1);
  test::RunningServer running(options);
  const auto client = running.NewClient();
  FrameRequest whole;
  whole.width = whole.height = 1000;
  const auto expect_room = [&] {
    auto frame = client->RenderFrame("ball", whole, "front", {}, nullptr);
    while (absl::IsResourceExhausted(frame.status())) {
      frame = client->RenderFrame("ball", whole, "front", {}, nullptr);
    }
    EXPECT_TRUE(frame.ok()) << frame.status();
  };
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);  // or the client's side might take a whole frame
  const auto lazy = v1::RadianceCache::NewStub(grpc::CreateCustomChannel(
      running.server().address(), grpc::InsecureChannelCredentials(), arguments));
  grpc::ClientContext context, fly_context;
  const auto stream = lazy->RenderFrame(&context, test::SmallFrame(1000, 1000));
  v1::FrameChunk chunk;
  ASSERT_TRUE(stream->Read(&chunk));
  expect_room();
  while (stream->Read(&chunk)) {
  }
  EXPECT_EQ(stream->Finish().error_code(), StatusCode::CANCELLED);
  const auto flight = lazy->Fly(&fly_context);
  v1::FlyRequest viewpoint = Viewpoint(0);
  *viewpoint.mutable_frame() = test::SmallFrame(1000, 1000);
  EXPECT_TRUE(flight->Write(viewpoint));
  v1::FlyReply reply;
  ASSERT_TRUE(flight->Read(&reply));
  expect_room();
  EXPECT_FALSE(ReadFrame(*flight));
  EXPECT_EQ(flight->Finish().error_code(), StatusCode::CANCELLED);
}

TEST(EndingsTest, AChannelThatIsDroppedMidFlightDoesNoHarm) {
  test::RunningServer running;
  for (int round = 0; round < 5; ++round) {
    grpc::ClientContext context;
    const auto channel =
        grpc::CreateChannel(running.server().address(), grpc::InsecureChannelCredentials());
    const auto stream = v1::RadianceCache::NewStub(channel)->Fly(&context);
    for (uint64_t i = 0; i < 30; ++i) EXPECT_TRUE(stream->Write(Viewpoint(i)));
    EXPECT_TRUE(ReadFrame(*stream));
  }
  running.ExpectServing();
}

TEST(EndingsTest, UnloadingDuringAFlightEndsItAtTheNextFrame) {
  test::RunningServer running;
  grpc::ClientContext context;
  const auto stream = running.stub().Fly(&context);
  EXPECT_TRUE(stream->Write(Viewpoint(0)));
  EXPECT_TRUE(ReadFrame(*stream));
  EXPECT_TRUE(running.client().UnloadScene("ball").ok());
  EXPECT_TRUE(stream->Write(Viewpoint(1)));
  EXPECT_FALSE(ReadFrame(*stream));
  const auto status = stream->Finish();
  EXPECT_EQ(status.error_code(), StatusCode::NOT_FOUND);
  EXPECT_THAT(status.error_message(), testing::StartsWith("frame.scene"));
}

TEST(EndingsTest, ScenesMayComeAndGoWhileFramesAreRendered) {
  test::RunningServer running;
  std::atomic<bool> stop = false;
  std::vector<std::thread> renderers;
  for (int i = 0; i < 2; ++i) {
    renderers.emplace_back([&] {
      const auto client = running.NewClient();
      FrameRequest request;
      request.width = request.height = 50;
      while (!stop) {
        const auto frame = client->RenderFrame("ball", request, "front", {}, nullptr);
        EXPECT_TRUE(frame.ok() || absl::IsNotFound(frame.status())) << frame.status();
      }
    });
  }
  for (int round = 0; round < 50; ++round) {
    EXPECT_TRUE(running.client().UnloadScene("ball").ok());
    EXPECT_TRUE(running.client().LoadScene("ball", test::BallScene(), false).ok());
  }
  stop = true;
  for (auto& renderer : renderers) renderer.join();
  running.ExpectServing();
}

TEST(EndingsTest, AFullQueueSaysWhenToComeBack) {
  ServerOptions options;
  options.limits.max_waiting_renders = 0;
  test::RunningServer running(options);
  grpc::ClientContext context;
  const auto stream = running.stub().RenderFrame(&context, test::SmallFrame());
  EXPECT_EQ(stream->Finish().error_code(), StatusCode::RESOURCE_EXHAUSTED);
  const auto& trailers = context.GetServerTrailingMetadata();
  const auto hint = trailers.find(kRetryPushbackKey);
  ASSERT_NE(hint, trailers.end());
  EXPECT_EQ(hint->second, std::to_string(options.limits.retry_after_ms.count()));
}

TEST(EndingsTest, FlightsAreCountedAndGiveTheirPlaceBack) {
  ServerOptions options;
  options.limits.max_flights = 1;
  test::RunningServer running(options);
  const auto client = running.NewClient({.retry = {.max_attempts = 5}});
  for (int round = 0; round < 3; ++round) {
    grpc::ClientContext context, refused_context;
    for (auto* call : {&context, &refused_context}) {
      call->set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(60));
    }
    const auto stream = running.stub().Fly(&context);
    EXPECT_TRUE(stream->Write(Viewpoint(0)));
    EXPECT_TRUE(ReadFrame(*stream));
    const auto refused = running.stub().Fly(&refused_context);
    EXPECT_EQ(refused->Finish().error_code(), StatusCode::RESOURCE_EXHAUSTED);
    stream->WritesDone();
    EXPECT_TRUE(stream->Finish().ok());
    FrameRequest request;
    request.camera.eye = {0, 3, 8};
    request.width = request.height = 8;
    const auto status = client->Fly("ball", {request}, {}, [](size_t, const Frame&) {});
    EXPECT_TRUE(status.ok()) << status;
  }
}

TEST(EndingsTest, AFlightThatSendsTooFarAheadIsNotRead) {
  ServerOptions options;
  options.limits.max_pending_viewpoints = 4;
  test::RunningServer running(options);
  grpc::ClientContext context;
  const auto stream = running.stub().Fly(&context);
  // While the first frame is rendered, the others are sent: many times what the buffers between
  // here and there hold.
  constexpr int kViewpoints = 500;
  std::atomic<int> written = 0;
  std::thread writer([&] {
    v1::FlyRequest request = Viewpoint(0);
    *request.mutable_frame() = test::EndlessFrame();
    for (; written < kViewpoints && stream->Write(request); ++written) {
      request = Viewpoint(1);
      request.mutable_frame()->set_camera_name(std::string(200'000, 'x'));
    }
  });
  v1::FlyReply reply;
  EXPECT_TRUE(stream->Read(&reply));
  EXPECT_LT(written, kViewpoints / 2);
  context.TryCancel();
  writer.join();
  EXPECT_EQ(stream->Finish().error_code(), StatusCode::CANCELLED);
}

TEST(EndingsTest, DrainingEndsIdleFlights) {
  test::RunningServer running;
  grpc::ClientContext context;
  const auto stream = running.stub().Fly(&context);
  EXPECT_TRUE(stream->Write(Viewpoint(0)));
  EXPECT_TRUE(ReadFrame(*stream));
  std::thread drain([&] { running.server().Drain(kAsLongAsItTakes); });
  EXPECT_FALSE(ReadFrame(*stream));
  EXPECT_EQ(stream->Finish().error_code(), StatusCode::UNAVAILABLE);
  drain.join();
}

TEST(EndingsTest, DrainingFinishesAFrameThatIsUnderWay) {
  test::RunningServer running;
  grpc::ClientContext context;
  const auto stream = running.stub().RenderFrame(&context, test::SmallFrame(1000, 1000));
  v1::FrameChunk chunk;
  ASSERT_TRUE(stream->Read(&chunk));
  std::thread drain([&] { running.server().Drain(kAsLongAsItTakes); });
  while (stream->Read(&chunk)) {
  }
  const auto status = stream->Finish();
  EXPECT_TRUE(status.ok()) << status.error_code() << ": " << status.error_message();
  EXPECT_TRUE(chunk.has_end());
  drain.join();
}

TEST(EndingsTest, DrainingCancelsWhatIsNotDoneInTime) {
  test::RunningServer running;
  grpc::ClientContext frame_context, flight_context;
  const auto frame = running.stub().RenderFrame(&frame_context, test::EndlessFrame());
  const auto flight = running.stub().Fly(&flight_context);
  v1::FlyRequest endless = Viewpoint(0);
  *endless.mutable_frame() = test::EndlessFrame();
  EXPECT_TRUE(flight->Write(endless));
  running.server().Drain(milliseconds(20));
  EXPECT_FALSE(frame->Finish().ok());
  EXPECT_FALSE(ReadFrame(*flight));  // though perhaps a farewell: the viewpoint may come too late
  EXPECT_FALSE(flight->Finish().ok());
  EXPECT_EQ(FramesRendered(running), 0u);
}

TEST(EndingsTest, ASecondServerDoesNotStealThePort) {
  test::RunningServer running;
  ServerOptions options;
  options.listen = running.server().address();
  const auto second = Server::Start(options, std::make_shared<spdlog::logger>("no sinks"));
  EXPECT_TRUE(absl::IsUnavailable(second.status())) << second.status();
}

}  // namespace
}  // namespace linetree
