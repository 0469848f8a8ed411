// The client against a server that misbehaves in every way it can think of.
#include "client/library/client.h"

#include <gmock/gmock.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <future>
#include <mutex>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/library/status.h"
#include "core/io/wire_frame.h"
#include "linetree/v1/service.grpc.pb.h"

namespace linetree {
namespace {

using testing::HasSubstr;

// Answers with what a test has laid out.
class ScriptedService : public v1::RadianceCache::Service {
 public:
  grpc::Status DescribeScene(grpc::ServerContext* context, const v1::DescribeSceneRequest* request,
                             v1::SceneInfo* info) override {
    ++calls;
    if (hold.valid()) hold.wait();
    if (calls <= failures) {
      if (!pushback_ms.empty()) context->AddTrailingMetadata(kRetryPushbackKey, pushback_ms);
      return {failure, "not now"};
    }
    info->set_name(request->scene());
    return grpc::Status::OK;
  }

  grpc::Status RenderFrame(grpc::ServerContext*, const v1::RenderFrameRequest*,
                           grpc::ServerWriter<v1::FrameChunk>* writer) override {
    const bool breaks = ++calls <= failures;
    const size_t count = breaks ? chunks.size() / 2 : chunks.size();
    for (size_t i = 0; i < count; ++i) writer->Write(chunks[i]);
    return breaks ? grpc::Status(failure, "not now") : grpc::Status::OK;
  }

  grpc::Status Fly(grpc::ServerContext*,
                   grpc::ServerReaderWriter<v1::FlyReply, v1::FlyRequest>* stream) override {
    v1::FlyRequest request;
    bool first = true;
    while (stream->Read(&request)) {
      if (std::exchange(first, false)) streams_begin_with.push_back(request.sequence());
      v1::FlyReply reply;
      reply.set_sequence(request.sequence() + sequence_error);
      for (const auto& chunk : chunks) {
        *reply.mutable_chunk() = chunk;
        stream->Write(reply);
      }
      if (++flown == frames_before_failure) {
        frames_before_failure += frames_between_failures;
        return {failure, "engine failure"};
      }
    }
    if (hold.valid()) hold.wait();
    return grpc::Status::OK;
  }

  std::atomic<int> calls = 0;
  int failures = 0;
  grpc::StatusCode failure = grpc::StatusCode::UNAVAILABLE;
  std::string pushback_ms;
  std::shared_future<void> hold;
  std::vector<v1::FrameChunk> chunks;
  uint64_t sequence_error = 0;
  int flown = 0;
  int frames_before_failure = -1;
  int frames_between_failures = 1 << 20;
  std::vector<uint64_t> streams_begin_with;
};

std::vector<v1::FrameChunk> ChunksOf(int width, int height) {
  Frame frame;
  frame.width = width;
  frame.height = height;
  frame.radiance.resize(static_cast<size_t>(3 * width * height), 0.5f);
  FrameChunks chunks = *FrameChunks::Make(frame, {});
  std::vector<v1::FrameChunk> messages;
  v1::FrameChunk chunk;
  while (chunks.Next(&chunk)) messages.push_back(chunk);
  return messages;
}

FrameRequest RequestOf(int width, int height) {
  FrameRequest request;
  request.width = width;
  request.height = height;
  return request;
}

class ClientTest : public testing::Test {
 protected:
  // Retries without waiting much.
  static constexpr RetryOptions kQuick{.max_attempts = 3,
                                       .first_delay_ms = std::chrono::milliseconds(1),
                                       .max_delay_ms = std::chrono::milliseconds(2)};

  ClientTest() { Listen("127.0.0.1:0"); }

  void Listen(const std::string& where) {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort(where, grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    ASSERT_NE(server_, nullptr);
    address_ = absl::StrCat("127.0.0.1:", port);
  }

  std::unique_ptr<Client> Connect(const ClientOptions& options = {}) {
    auto client = Client::Connect(address_, options);
    EXPECT_TRUE(client.ok()) << client.status();
    return *std::move(client);
  }

  ScriptedService service_;
  std::unique_ptr<grpc::Server> server_;
  std::string address_;
};

TEST_F(ClientTest, UnavailableIsTriedAgain) {
  service_.failures = 2;
  const auto info = Connect()->DescribeScene("room");
  ASSERT_TRUE(info.ok()) << info.status();
  EXPECT_EQ(info->name(), "room");
  EXPECT_EQ(service_.calls, 3);
}

TEST_F(ClientTest, ButNotForEver) {
  service_.failures = 100;
  const auto info = Connect({.retry = {.max_attempts = 2}})->DescribeScene("room");
  EXPECT_TRUE(absl::IsUnavailable(info.status()));
  EXPECT_THAT(std::string(info.status().message()), HasSubstr("not now"));
  EXPECT_EQ(service_.calls, 2);
}

TEST_F(ClientTest, OneAttemptIsOne) {
  service_.failures = 1;
  EXPECT_FALSE(Connect({.retry = {.max_attempts = 1}})->DescribeScene("room").ok());
  EXPECT_EQ(service_.calls, 1);
}

TEST_F(ClientTest, NoRoomIsTriedAgainWhenTheServerSaysSo) {
  service_.failures = 1;
  service_.failure = grpc::StatusCode::RESOURCE_EXHAUSTED;
  service_.pushback_ms = "1";
  EXPECT_TRUE(Connect()->DescribeScene("room").ok());
  EXPECT_EQ(service_.calls, 2);
}

TEST_F(ClientTest, ARefusalForGoodIsNotRepeated) {
  service_.failures = 1;
  service_.failure = grpc::StatusCode::RESOURCE_EXHAUSTED;
  service_.pushback_ms = "-1";
  EXPECT_TRUE(absl::IsResourceExhausted(Connect()->DescribeScene("room").status()));
  EXPECT_EQ(service_.calls, 1);
}

TEST_F(ClientTest, OtherErrorsAreNotRepeated) {
  service_.failures = 1;
  service_.failure = grpc::StatusCode::NOT_FOUND;
  EXPECT_TRUE(absl::IsNotFound(Connect()->DescribeScene("room").status()));
  EXPECT_EQ(service_.calls, 1);
}

TEST_F(ClientTest, EveryCallHasADeadline) {
  std::promise<void> release;
  service_.hold = release.get_future().share();
  const auto info =
      Connect({.call_timeout_ms = std::chrono::milliseconds(50)})->DescribeScene("room");
  release.set_value();
  EXPECT_EQ(info.status().code(), absl::StatusCode::kDeadlineExceeded);
}

TEST_F(ClientTest, NobodyThere) {
  server_->Shutdown();
  server_.reset();
  const auto client =
      Client::Connect(address_, {.connect_timeout_ms = std::chrono::milliseconds(50)});
  EXPECT_TRUE(absl::IsUnavailable(client.status()));
  EXPECT_THAT(std::string(client.status().message()), HasSubstr(address_));
}

TEST_F(ClientTest, AWholeFrameArrives) {
  service_.chunks = ChunksOf(100, 70);
  const auto frame = Connect()->RenderFrame("room", RequestOf(100, 70), "", {}, nullptr);
  ASSERT_TRUE(frame.ok()) << frame.status();
  EXPECT_EQ(frame->radiance, PixelLayer<float>(3 * 100 * 70, 0.5f));
}

TEST_F(ClientTest, AFrameThatBreaksOffIsAskedForAgain) {
  service_.chunks = ChunksOf(100, 70);
  service_.failures = 1;
  const auto frame =
      Connect({.retry = kQuick})->RenderFrame("room", RequestOf(100, 70), "", {}, nullptr);
  ASSERT_TRUE(frame.ok()) << frame.status();
  EXPECT_EQ(frame->radiance, PixelLayer<float>(3 * 100 * 70, 0.5f));
  EXPECT_EQ(service_.calls, 2);
}

TEST_F(ClientTest, AFrameWithoutItsEndIsDataLoss) {
  service_.chunks = ChunksOf(100, 70);
  service_.chunks.pop_back();
  const auto client = Connect();
  EXPECT_TRUE(
      absl::IsDataLoss(client->RenderFrame("room", RequestOf(100, 70), "", {}, nullptr).status()));
  service_.chunks.clear();
  EXPECT_TRUE(
      absl::IsDataLoss(client->RenderFrame("room", RequestOf(100, 70), "", {}, nullptr).status()));
}

TEST_F(ClientTest, AFrameOfAnotherSizeIsDataLoss) {
  service_.chunks = ChunksOf(100, 70);
  EXPECT_TRUE(absl::IsDataLoss(
      Connect()->RenderFrame("room", RequestOf(90, 70), "", {}, nullptr).status()));
  EXPECT_TRUE(absl::IsDataLoss(
      Connect()->Fly("room", {RequestOf(101, 70)}, {}, [](size_t, const Frame&) {})));
}

TEST_F(ClientTest, SizesThatNoFrameHasAreNotSent) {
  for (const auto& [width, height] : {std::pair(0, 5), {5, -1}}) {
    EXPECT_TRUE(absl::IsInvalidArgument(
        Connect()->RenderFrame("room", RequestOf(width, height), "", {}, nullptr).status()));
    EXPECT_TRUE(absl::IsInvalidArgument(
        Connect()->Fly("room", {RequestOf(width, height)}, {}, [](size_t, const Frame&) {})));
  }
}

TEST_F(ClientTest, AFlightDeliversInOrder) {
  service_.chunks = ChunksOf(8, 8);
  size_t expected = 0;
  const auto status =
      Connect()->Fly("room", std::vector<FrameRequest>(50, RequestOf(8, 8)), {},
                     [&](size_t index, const Frame&) { EXPECT_EQ(index, expected++); });
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_EQ(expected, 50u);
}

TEST_F(ClientTest, AFlightOfNoFramesIsFine) {
  EXPECT_TRUE(Connect()->Fly("room", {}, {}, [](size_t, const Frame&) { FAIL(); }).ok());
}

TEST_F(ClientTest, AFlightThatFailsHasTheServersWords) {
  service_.chunks = ChunksOf(8, 8);
  service_.frames_before_failure = 3;
  service_.failure = grpc::StatusCode::NOT_FOUND;
  int frames = 0;
  const auto status = Connect()->Fly("room", std::vector<FrameRequest>(50, RequestOf(8, 8)), {},
                                     [&](size_t, const Frame&) { ++frames; });
  EXPECT_TRUE(absl::IsNotFound(status)) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("engine failure"));
  EXPECT_EQ(frames, 3);
}

TEST_F(ClientTest, AFlightGoesOnWithTheFirstFrameThatIsMissing) {
  service_.chunks = ChunksOf(8, 8);
  service_.frames_before_failure = 3;
  service_.frames_between_failures = 4;
  size_t expected = 0;
  // Each stream brings something on, so there may be more of them than attempts.
  const auto status = Connect({.retry = kQuick})
                          ->Fly("room", std::vector<FrameRequest>(20, RequestOf(8, 8)), {},
                                [&](size_t index, const Frame&) { EXPECT_EQ(index, expected++); });
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_EQ(expected, 20u);
  EXPECT_EQ(service_.streams_begin_with, (std::vector<uint64_t>{0, 3, 7, 11, 15, 19}));
}

TEST_F(ClientTest, AFlightThatGetsNowhereEnds) {
  service_.chunks = ChunksOf(8, 8);
  service_.chunks.pop_back();
  service_.frames_before_failure = 1;
  service_.frames_between_failures = 1;
  const auto status =
      Connect({.retry = kQuick})->Fly("room", {RequestOf(8, 8)}, {}, [](size_t, const Frame&) {});
  EXPECT_TRUE(absl::IsUnavailable(status)) << status;
  EXPECT_EQ(service_.streams_begin_with.size(), static_cast<size_t>(kQuick.max_attempts));
}

// Frames come back one for each request here, so none is lost when nothing else is sent meanwhile.
TEST_F(ClientTest, ALiveFlightGoesOnWithTheNewestViewpoint) {
  service_.chunks = ChunksOf(8, 8);
  service_.frames_before_failure = 1;
  service_.frames_between_failures = 1;
  const auto client = Connect({.retry = kQuick});
  std::mutex mutex;
  std::condition_variable came;
  std::vector<uint64_t> views;
  const auto flight = client->Steer("room", {}, [&](const LiveFrame& frame) {
    const std::lock_guard lock(mutex);
    views.push_back(frame.view);
    came.notify_all();
  });
  for (uint64_t view = 0; view < 10; ++view) {
    EXPECT_EQ(*flight->Look(RequestOf(8, 8)), view);
    std::unique_lock lock(mutex);
    came.wait(lock, [&] { return views.size() > view; });
  }
  EXPECT_TRUE(flight->Land().ok()) << flight->Land();
  EXPECT_EQ(views, (std::vector<uint64_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

TEST_F(ClientTest, ALiveFlightThatGetsNowhereEnds) {
  service_.chunks = ChunksOf(8, 8);
  service_.chunks.pop_back();
  service_.frames_before_failure = 1;
  service_.frames_between_failures = 1;
  const auto client = Connect({.retry = kQuick});
  const auto flight = client->Steer("room", {}, [](const LiveFrame&) { FAIL(); });
  EXPECT_TRUE(flight->Look(RequestOf(8, 8)).ok());
  EXPECT_TRUE(absl::IsUnavailable(flight->Land())) << flight->Land();
  EXPECT_EQ(service_.streams_begin_with,
            std::vector<uint64_t>(static_cast<size_t>(kQuick.max_attempts), 0));
}

TEST_F(ClientTest, ALiveFlightWaitsForAFrameOnlySoLong) {
  service_.chunks = ChunksOf(8, 8);
  service_.chunks.pop_back();  // so that no frame is ever complete
  std::promise<void> release;
  service_.hold = release.get_future().share();
  const auto client = Connect({.call_timeout_ms = std::chrono::milliseconds(50)});
  const auto flight = client->Steer("room", {}, [](const LiveFrame&) { FAIL(); });
  EXPECT_TRUE(flight->Look(RequestOf(8, 8)).ok());
  EXPECT_EQ(flight->Land().code(), absl::StatusCode::kDeadlineExceeded) << flight->Land();
  release.set_value();
}

TEST_F(ClientTest, LiveFramesThatNobodyAskedForAreDataLoss) {
  service_.chunks = ChunksOf(8, 8);
  service_.sequence_error = 1;
  const auto client = Connect();
  const auto flight = client->Steer("room", {}, [](const LiveFrame&) { FAIL(); });
  EXPECT_TRUE(flight->Look(RequestOf(8, 8)).ok());
  EXPECT_TRUE(absl::IsDataLoss(flight->Land())) << flight->Land();
}

TEST_F(ClientTest, AServerThatComesBackIsFound) {
  service_.chunks = ChunksOf(8, 8);
  const auto client = Connect({.retry = kQuick});
  EXPECT_TRUE(client->DescribeScene("room").ok());
  server_->Shutdown();
  server_.reset();
  std::thread call([&] { EXPECT_TRUE(client->DescribeScene("room").ok()); });
  Listen(address_);
  call.join();
  EXPECT_TRUE(client->Fly("room", {RequestOf(8, 8)}, {}, [](size_t, const Frame&) {}).ok());
}

TEST_F(ClientTest, FramesOutOfOrderAreDataLoss) {
  service_.chunks = ChunksOf(8, 8);
  service_.sequence_error = 1;
  EXPECT_TRUE(absl::IsDataLoss(
      Connect()->Fly("room", {RequestOf(8, 8)}, {}, [](size_t, const Frame&) { FAIL(); })));
}

}  // namespace
}  // namespace linetree
