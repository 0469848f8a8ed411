// The class in which what clients ask for waits: theirs to say, and what it is when they do not.
#include <future>
#include <thread>

#include "client/library/status.h"
#include "server/wire_priority.h"
#include "tests/server/running_server.h"

namespace linetree {
namespace {

using testing::ElementsAre;
using testing::StartsWith;

TEST(PriorityTest, TheNumbersOfTheWireAreClasses) {
  for (const auto usual : {Priority::kInteractive, Priority::kBatch}) {
    EXPECT_EQ(*PriorityFromWire(v1::PRIORITY_UNSPECIFIED, usual, "p"), usual);
    EXPECT_EQ(*PriorityFromWire(v1::PRIORITY_INTERACTIVE, usual, "p"), Priority::kInteractive);
    EXPECT_EQ(*PriorityFromWire(v1::PRIORITY_BATCH, usual, "p"), Priority::kBatch);
    EXPECT_EQ(*PriorityFromWire(v1::PRIORITY_BACKGROUND, usual, "p"), Priority::kBackground);
  }
  const auto unknown = PriorityFromWire(static_cast<v1::Priority>(9), Priority::kBatch, "p");
  EXPECT_TRUE(absl::IsInvalidArgument(unknown.status()));
  EXPECT_THAT(std::string(unknown.status().message()), StartsWith("p: expected"));
}

ServerOptions OneSlot() {
  ServerOptions options;
  options.render_slots = 1;
  options.prefetch = false;
  return options;
}

// A server whose only slot is taken until Release.
class WaitingTest : public testing::Test {
 public:
  WaitingTest() {
    std::promise<void> taken;
    EXPECT_TRUE(running_.server()
                    .backend()
                    .renders()
                    .Submit({},
                            [&, released = released_.get_future().share()](const absl::Status&) {
                              taken.set_value();
                              released.wait();
                            })
                    .ok());
    taken.get_future().wait();
  }
  void Release() { released_.set_value(); }

  // By class, when so many wait.
  std::array<size_t, kPriorities> AwaitWaiting(size_t jobs) {
    while (running_.server().backend().renders().waiting() < jobs) std::this_thread::yield();
    return running_.server().backend().CurrentLoad().waiting_renders;
  }

  // Calls that wait, each in a thread of its own.
  void Render(v1::Priority priority) {
    calls_.push_back(std::async(std::launch::async, [this, priority] {
      v1::RenderFrameRequest request = test::SmallFrame();
      request.set_priority(priority);
      grpc::ClientContext context;
      const auto stream = running_.stub().RenderFrame(&context, request);
      v1::FrameChunk chunk;
      while (stream->Read(&chunk)) {
      }
      return stream->Finish();
    }));
  }
  void Trace(v1::Priority priority) {
    calls_.push_back(std::async(std::launch::async, [this, priority] {
      v1::TraceRaysRequest request;
      request.set_scene("ball");
      request.add_rays()->mutable_direction()->set_z(-1);
      request.set_priority(priority);
      grpc::ClientContext context;
      v1::TraceRaysReply reply;
      return running_.stub().TraceRays(&context, request, &reply);
    }));
  }
  void Fly(v1::Priority priority) {
    calls_.push_back(std::async(std::launch::async, [this, priority] {
      v1::FlyRequest request;
      *request.mutable_frame() = test::SmallFrame();
      request.mutable_frame()->set_priority(priority);
      grpc::ClientContext context;
      const auto stream = running_.stub().Fly(&context);
      stream->Write(request);
      stream->WritesDone();
      v1::FlyReply reply;
      while (stream->Read(&reply)) {
      }
      return stream->Finish();
    }));
  }
  void ExpectAllWell() {
    Release();
    for (auto& call : calls_) {
      const grpc::Status status = call.get();
      EXPECT_TRUE(status.ok()) << status.error_message();
    }
  }

  test::RunningServer running_{OneSlot()};
  std::promise<void> released_;
  std::vector<std::future<grpc::Status>> calls_;
};

TEST_F(WaitingTest, FramesAreInteractiveAndRaysABatchUnlessTheySayOtherwise) {
  Render(v1::PRIORITY_UNSPECIFIED);
  Fly(v1::PRIORITY_UNSPECIFIED);
  Trace(v1::PRIORITY_UNSPECIFIED);
  EXPECT_THAT(AwaitWaiting(3), ElementsAre(2, 1, 0));
  Trace(v1::PRIORITY_INTERACTIVE);
  EXPECT_THAT(AwaitWaiting(4), ElementsAre(3, 1, 0));
  Render(v1::PRIORITY_BATCH);
  Fly(v1::PRIORITY_BATCH);
  EXPECT_THAT(AwaitWaiting(6), ElementsAre(3, 3, 0));
  for (const auto ask : {&WaitingTest::Render, &WaitingTest::Fly, &WaitingTest::Trace}) {
    (this->*ask)(v1::PRIORITY_BACKGROUND);
  }
  EXPECT_THAT(AwaitWaiting(9), ElementsAre(3, 3, 3));
  ExpectAllWell();
}

TEST_F(WaitingTest, TheClientsLibraryNamesItsClass) {
  const auto client = running_.NewClient({.priority = v1::PRIORITY_BACKGROUND});
  FrameRequest request;
  request.camera.eye = {0, 3, 8};
  request.width = request.height = 8;
  calls_.push_back(std::async(std::launch::async, [&] {
    return ToGrpc(client->RenderFrame("ball", request, "", {}, nullptr).status());
  }));
  calls_.push_back(std::async(std::launch::async, [&] {
    return ToGrpc(client->Fly("ball", {request}, {}, [](size_t, const Frame&) {}));
  }));
  calls_.push_back(std::async(std::launch::async, [&] {
    return ToGrpc(client->TraceRays("ball", {{{0, 3, 8}, {0, 0, -1}}}, {}).status());
  }));
  const auto flight = client->Steer("ball", {}, [](const LiveFrame&) {});
  EXPECT_TRUE(flight->Look(request).ok());
  EXPECT_THAT(AwaitWaiting(4), ElementsAre(0, 0, 4));
  ExpectAllWell();
  EXPECT_TRUE(flight->Land().ok());
}

TEST_F(WaitingTest, WhatIsNoClassIsRefused) {
  const auto unknown = static_cast<v1::Priority>(7);
  for (const auto ask : {&WaitingTest::Render, &WaitingTest::Trace, &WaitingTest::Fly}) {
    (this->*ask)(unknown);
  }
  Release();
  std::vector<std::string> fields = {"priority: ", "priority: ", "frame.priority: "};
  for (size_t i = 0; i < fields.size(); ++i) {
    const grpc::Status status = calls_[i].get();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_THAT(status.error_message(), StartsWith(fields[i]));
  }
}

}  // namespace
}  // namespace linetree
