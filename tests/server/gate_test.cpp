// What stands in front of every RPC: tokens, request ids, health; on a real server.
#include <grpcpp/generic/generic_stub.h>

#include <fstream>
#include <future>

#include "server/call_info.h"
#include "tests/io/temp_dir.h"
#include "tests/server/running_server.h"

namespace linetree {
namespace {

using grpc::StatusCode;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

constexpr char kViewer[] = "looks-and-no-more";
constexpr char kAdmin[] = "may-do-everything";

class GateTest : public testing::Test {
 protected:
  GateTest() {
    std::ofstream(dir_.File("tokens")) << "viewer " << kViewer << "\nadmin " << kAdmin << "\n";
    ServerOptions options;
    options.token_file = dir_.File("tokens");
    running_ = std::make_unique<test::RunningServer>(
        options, std::make_shared<spdlog::logger>("no sinks"), ClientOptions{.token = kAdmin});
  }

  // An empty message to the method, with or without a token.
  grpc::Status Send(const std::string& method, const std::string& token) {
    grpc::ClientContext context;
    if (!token.empty()) context.AddMetadata("authorization", "Bearer " + token);
    grpc::GenericStub generic(running_->channel());
    const grpc::Slice nothing;
    grpc::ByteBuffer request(&nothing, 1), reply;
    std::promise<grpc::Status> status;
    generic.UnaryCall(&context, method, {}, &request, &reply,
                      [&](grpc::Status s) { status.set_value(std::move(s)); });
    return status.get_future().get();
  }

  TempDir dir_;
  std::unique_ptr<test::RunningServer> running_;
};

TEST_F(GateTest, EveryMethodAsksForATokenAndKnowsItsRole) {
  const auto* service =
      v1::GetLimitsReply::descriptor()->file()->FindServiceByName("RadianceCache");
  std::vector<std::string> for_admins;
  for (int i = 0; i < service->method_count(); ++i) {
    const std::string method =
        "/" + service->full_name() + "/" + std::string(service->method(i)->name());
    EXPECT_EQ(Send(method, "").error_code(), StatusCode::UNAUTHENTICATED) << method;
    EXPECT_EQ(Send(method, "a-token-of-nobody").error_code(), StatusCode::UNAUTHENTICATED);
    const auto code = Send(method, kViewer).error_code();
    EXPECT_NE(code, StatusCode::UNAUTHENTICATED) << method;
    if (code == StatusCode::PERMISSION_DENIED) for_admins.push_back(service->method(i)->name());
    const auto admins = Send(method, kAdmin);
    EXPECT_NE(admins.error_code(), StatusCode::UNAUTHENTICATED) << method;
    EXPECT_NE(admins.error_code(), StatusCode::PERMISSION_DENIED) << method;
    EXPECT_NE(admins.error_code(), StatusCode::UNIMPLEMENTED) << method;
  }
  EXPECT_THAT(for_admins,
              UnorderedElementsAre("LoadScene", "UnloadScene", "UpdateScene", "TuneCache"));
}

TEST_F(GateTest, StreamsAreRefusedToo) {
  grpc::ClientContext fly_context, frame_context;
  const auto flight = running_->stub().Fly(&fly_context);
  v1::FlyReply reply;
  EXPECT_FALSE(flight->Read(&reply));
  EXPECT_EQ(flight->Finish().error_code(), StatusCode::UNAUTHENTICATED);
  const auto frame = running_->stub().RenderFrame(&frame_context, test::SmallFrame());
  v1::FrameChunk chunk;
  EXPECT_FALSE(frame->Read(&chunk));
  EXPECT_EQ(frame->Finish().error_code(), StatusCode::UNAUTHENTICATED);
}

TEST_F(GateTest, TheClientsLibraryShowsItsToken) {
  const auto viewer = running_->NewClient({.token = kViewer});
  EXPECT_TRUE(viewer->ListScenes().ok());
  EXPECT_TRUE(absl::IsPermissionDenied(viewer->UnloadScene("ball")));
  FrameRequest request;
  request.camera.eye = {0, 3, 8};
  request.width = request.height = 8;
  EXPECT_TRUE(viewer->Fly("ball", {request}, {}, [](size_t, const Frame&) {}).ok());
  running_->ExpectServing();
}

TEST_F(GateTest, RequestIdsComeBack) {
  const auto id_of = [&](const std::string& sent) {
    grpc::ClientContext context;
    if (!sent.empty()) context.AddMetadata(kRequestIdKey, sent);
    v1::ListScenesReply reply;
    // Refused, and named all the same.
    EXPECT_FALSE(running_->stub().ListScenes(&context, {}, &reply).ok());
    const auto& metadata = context.GetServerTrailingMetadata();
    const auto [begin, end] = metadata.equal_range(kRequestIdKey);
    EXPECT_EQ(std::distance(begin, end), 1);
    return begin == end ? "" : std::string(begin->second.data(), begin->second.size());
  };
  EXPECT_EQ(id_of("shot-7.frame:12"), "shot-7.frame:12");
  const std::string made_up = id_of("");
  EXPECT_EQ(made_up.size(), 32u) << made_up;
  for (const std::string& bad : {std::string("two words"), std::string(129, 'x')}) {
    EXPECT_NE(id_of(bad), bad);
    EXPECT_EQ(id_of(bad).size(), 32u);
  }
  EXPECT_NE(id_of(""), made_up);
}

}  // namespace
}  // namespace linetree
