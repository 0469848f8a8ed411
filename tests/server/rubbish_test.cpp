// Rubbish of all kinds: the code is right, the message names the field, the server goes on serving.
#include <arpa/inet.h>
#include <grpcpp/generic/generic_stub.h>
#include <sys/socket.h>
#include <unistd.h>

#include <future>
#include <limits>

#include "absl/strings/numbers.h"
#include "tests/server/running_server.h"

namespace linetree {
namespace {

using grpc::StatusCode;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

struct BadFrame {
  const char* what;
  void (*spoil)(v1::RenderFrameRequest& request);
  StatusCode code;
  const char* field;
};

using Request = v1::RenderFrameRequest;
const BadFrame kBadFrames[] = {
    {"no_scene", [](Request& r) { r.clear_scene(); }, StatusCode::INVALID_ARGUMENT, "scene"},
    {"unknown_scene", [](Request& r) { r.set_scene("gone"); }, StatusCode::NOT_FOUND, "scene"},
    {"scene_name_with_newline", [](Request& r) { r.set_scene("a\nb"); },
     StatusCode::INVALID_ARGUMENT, "scene"},
    {"unknown_camera", [](Request& r) { r.set_camera_name("gone"); }, StatusCode::NOT_FOUND,
     "camera_name"},
    {"nan_eye", [](Request& r) { r.mutable_camera()->mutable_eye()->set_y(kNan); },
     StatusCode::INVALID_ARGUMENT, "camera.eye"},
    {"infinite_look_at", [](Request& r) { r.mutable_camera()->mutable_look_at()->set_x(kInf); },
     StatusCode::INVALID_ARGUMENT, "camera.look_at"},
    {"looks_at_its_eye", [](Request& r) { r.mutable_camera(); }, StatusCode::INVALID_ARGUMENT,
     "camera.look_at"},
    {"up_is_forward",
     [](Request& r) {
       r.mutable_camera()->mutable_eye()->set_y(5);
       r.mutable_camera()->mutable_up()->set_y(1);
     },
     StatusCode::INVALID_ARGUMENT, "camera.up"},
    {"flat_angle",
     [](Request& r) {
       r.mutable_camera()->mutable_eye()->set_z(5);
       r.mutable_camera()->set_fov_deg(180);
     },
     StatusCode::INVALID_ARGUMENT, "camera.fov_deg"},
    {"no_width", [](Request& r) { r.set_width(0); }, StatusCode::INVALID_ARGUMENT, "width"},
    {"no_height", [](Request& r) { r.clear_height(); }, StatusCode::INVALID_ARGUMENT, "height"},
    {"enormous_width", [](Request& r) { r.set_width(4294967295u); }, StatusCode::RESOURCE_EXHAUSTED,
     "width"},
    {"enormous_area",
     [](Request& r) {
       r.set_width(16384);
       r.set_height(16384);
     },
     StatusCode::RESOURCE_EXHAUSTED, "width"},
    {"nan_error", [](Request& r) { r.mutable_options()->set_max_relative_error(kNan); },
     StatusCode::INVALID_ARGUMENT, "options.max_relative_error"},
    {"negative_error", [](Request& r) { r.mutable_options()->set_max_relative_error(-0.1); },
     StatusCode::INVALID_ARGUMENT, "options.max_relative_error"},
    {"error_above_one", [](Request& r) { r.mutable_options()->set_max_relative_error(1.5); },
     StatusCode::INVALID_ARGUMENT, "options.max_relative_error"},
    {"no_depth", [](Request& r) { r.mutable_options()->set_max_depth(0); },
     StatusCode::INVALID_ARGUMENT, "options.max_depth"},
    {"enormous_depth", [](Request& r) { r.mutable_options()->set_max_depth(4294967295u); },
     StatusCode::INVALID_ARGUMENT, "options.max_depth"},
    {"nan_weight", [](Request& r) { r.mutable_options()->set_min_weight(kNan); },
     StatusCode::INVALID_ARGUMENT, "options.min_weight"},
    {"unknown_mode", [](Request& r) { r.mutable_options()->set_mode(static_cast<v1::Mode>(9)); },
     StatusCode::INVALID_ARGUMENT, "options.mode"},
    {"unknown_codec", [](Request& r) { r.set_codec(static_cast<v1::Codec>(6)); },
     StatusCode::INVALID_ARGUMENT, "codec"},
    {"negative_codec", [](Request& r) { r.set_codec(static_cast<v1::Codec>(-1)); },
     StatusCode::INVALID_ARGUMENT, "codec"},
    {"jpeg_of_quality_101", [](Request& r) { r.set_jpeg_quality(101); },
     StatusCode::INVALID_ARGUMENT, "jpeg_quality"},
    {"layers_of_a_picture",
     [](Request& r) {
       r.set_codec(v1::CODEC_PNG);
       r.set_all_layers(true);
     },
     StatusCode::INVALID_ARGUMENT, "all_layers"},
    {"unknown_judge",
     [](Request& r) { r.mutable_options()->set_judge(static_cast<v1::Judge>(-3)); },
     StatusCode::INVALID_ARGUMENT, "options.judge"},
};

// One server for the table: each case also shows that the one before did no harm.
class Rubbish : public testing::Test {
 protected:
  static void SetUpTestSuite() { running_ = new test::RunningServer; }
  static void TearDownTestSuite() {
    running_->ExpectServing();
    delete running_;
    running_ = nullptr;
  }
  static v1::RadianceCache::Stub& stub() { return running_->stub(); }

  // Sends bytes to a method and waits for the status.
  static grpc::Status Send(const std::string& method, const grpc::ByteBuffer& bytes,
                           grpc::ClientContext& context) {
    grpc::GenericStub generic(running_->channel());
    grpc::ByteBuffer reply;
    std::promise<grpc::Status> status;
    generic.UnaryCall(&context, "/linetree.v1.RadianceCache/" + method, {}, &bytes, &reply,
                      [&](grpc::Status s) { status.set_value(std::move(s)); });
    return status.get_future().get();
  }

  static inline test::RunningServer* running_ = nullptr;
};

class BadFrames : public Rubbish, public testing::WithParamInterface<BadFrame> {};

TEST_P(BadFrames, AreRefusedByRenderFrame) {
  Request request = test::SmallFrame();
  GetParam().spoil(request);
  grpc::ClientContext context;
  const auto stream = stub().RenderFrame(&context, request);
  v1::FrameChunk chunk;
  EXPECT_FALSE(stream->Read(&chunk));
  const auto status = stream->Finish();
  EXPECT_EQ(status.error_code(), GetParam().code) << status.error_message();
  EXPECT_THAT(status.error_message(), StartsWith(GetParam().field));
}

TEST_P(BadFrames, EndAFlightAfterTheFramesBeforeThem) {
  grpc::ClientContext context;
  const auto stream = stub().Fly(&context);
  v1::FlyRequest request;
  *request.mutable_frame() = test::SmallFrame();
  EXPECT_TRUE(stream->Write(request));
  GetParam().spoil(*request.mutable_frame());
  request.set_sequence(1);
  EXPECT_TRUE(stream->Write(request));
  int ends = 0;
  v1::FlyReply reply;
  while (stream->Read(&reply)) ends += reply.chunk().has_end() ? 1 : 0;
  EXPECT_EQ(ends, 1);
  const auto status = stream->Finish();
  EXPECT_EQ(status.error_code(), GetParam().code) << status.error_message();
  EXPECT_THAT(status.error_message(), StartsWith(std::string("frame.") + GetParam().field));
}

INSTANTIATE_TEST_SUITE_P(All, BadFrames, testing::ValuesIn(kBadFrames),
                         [](const auto& info) { return info.param.what; });

struct BadScene {
  const char* what;
  void (*spoil)(v1::LoadSceneRequest& request);
  const char* field;
};

const BadScene kBadScenes[] = {
    {"no_name", [](v1::LoadSceneRequest& r) { r.clear_name(); }, "name"},
    {"long_name", [](v1::LoadSceneRequest& r) { r.set_name(std::string(129, 'x')); }, "name"},
    {"path_as_name", [](v1::LoadSceneRequest& r) { r.set_name("../up"); }, "name"},
    {"no_content", [](v1::LoadSceneRequest& r) { r.clear_content(); }, "content"},
    {"unknown_format",
     [](v1::LoadSceneRequest& r) {
       r.set_format(static_cast<v1::LoadSceneRequest::TextFormat>(7));
     },
     "format"},
    {"nan_radius",
     [](v1::LoadSceneRequest& r) {
       r.mutable_scene()->mutable_objects(0)->mutable_sphere()->set_radius(kNan);
     },
     "objects[0]"},
    {"unknown_material",
     [](v1::LoadSceneRequest& r) { r.mutable_scene()->mutable_objects(1)->set_material("gone"); },
     "objects[1].material"},
};

class BadScenes : public Rubbish, public testing::WithParamInterface<BadScene> {};

TEST_P(BadScenes, AreRefused) {
  v1::LoadSceneRequest request;
  request.set_name("rubbish");
  *request.mutable_scene() = test::BallScene();
  GetParam().spoil(request);
  grpc::ClientContext context;
  v1::SceneInfo info;
  const auto status = stub().LoadScene(&context, request, &info);
  EXPECT_EQ(status.error_code(), StatusCode::INVALID_ARGUMENT) << status.error_message();
  EXPECT_THAT(status.error_message(), HasSubstr(GetParam().field));
}

INSTANTIATE_TEST_SUITE_P(All, BadScenes, testing::ValuesIn(kBadScenes),
                         [](const auto& info) { return info.param.what; });

TEST_F(Rubbish, BadRaysAreNamedByTheirIndex) {
  const auto trace = [](auto spoil) {
    v1::TraceRaysRequest request;
    request.set_scene("ball");
    for (int i = 0; i < 9; ++i) request.add_rays()->mutable_direction()->set_z(1);
    spoil(request);
    grpc::ClientContext context;
    v1::TraceRaysReply reply;
    return stub().TraceRays(&context, request, &reply);
  };
  using R = v1::TraceRaysRequest;
  auto status = trace([](R& r) { r.mutable_rays(7)->mutable_origin()->set_x(kNan); });
  EXPECT_EQ(status.error_code(), StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), StartsWith("rays[7].origin"));
  status = trace([](R& r) { r.mutable_rays(3)->clear_direction(); });
  EXPECT_EQ(status.error_code(), StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), StartsWith("rays[3].direction"));
  status = trace([](R& r) { r.set_scene("gone"); });
  EXPECT_EQ(status.error_code(), StatusCode::NOT_FOUND);
  status = trace([](R& r) { r.mutable_options()->set_max_relative_error(kNan); });
  EXPECT_THAT(status.error_message(), StartsWith("options.max_relative_error"));
}

TEST_F(Rubbish, TenMillionRaysAreTooManyRays) {
  v1::TraceRaysRequest thousand;
  for (int i = 0; i < 1000; ++i) {
    v1::Ray* ray = thousand.add_rays();
    for (v1::Vec3* v : {ray->mutable_origin(), ray->mutable_direction()}) {
      v->set_x(0.1);
      v->set_y(0.2);
      v->set_z(0.3);
    }
  }
  // Messages that follow one another are one message with all their rays.
  const std::vector<grpc::Slice> slices(10'000, grpc::Slice(thousand.SerializeAsString()));
  grpc::ClientContext context;
  const auto status = Send("TraceRays", grpc::ByteBuffer(slices.data(), slices.size()), context);
  EXPECT_EQ(status.error_code(), StatusCode::RESOURCE_EXHAUSTED) << status.error_message();
  EXPECT_THAT(status.error_message(), StartsWith("rays: "));
  EXPECT_THAT(status.error_message(), HasSubstr("10000000"));
}

TEST_F(Rubbish, UnknownScenesAreNotFoundByTheSmallCalls) {
  grpc::ClientContext describe, unload, stats;
  v1::DescribeSceneRequest describe_request;
  describe_request.set_scene("gone");
  v1::SceneInfo info;
  auto status = stub().DescribeScene(&describe, describe_request, &info);
  EXPECT_EQ(status.error_code(), StatusCode::NOT_FOUND);
  EXPECT_THAT(status.error_message(), StartsWith("scene"));
  v1::UnloadSceneRequest unload_request;
  v1::UnloadSceneReply unload_reply;
  status = stub().UnloadScene(&unload, unload_request, &unload_reply);
  EXPECT_EQ(status.error_code(), StatusCode::INVALID_ARGUMENT);
  v1::GetStatsRequest stats_request;
  stats_request.set_scene("gone");
  v1::GetStatsReply stats_reply;
  status = stub().GetStats(&stats, stats_request, &stats_reply);
  EXPECT_EQ(status.error_code(), StatusCode::NOT_FOUND);
}

TEST_F(Rubbish, MalformedMessagesAreInvalidForEveryMethod) {
  for (const std::string method : {"LoadScene", "ListScenes", "DescribeScene", "UnloadScene",
                                   "RenderFrame", "Fly", "TraceRays", "GetStats", "GetLimits"}) {
    const grpc::Slice garbage("\xff\xff\xff\xff half a message");
    grpc::ClientContext context;
    const auto status = Send(method, grpc::ByteBuffer(&garbage, 1), context);
    EXPECT_EQ(status.error_code(), StatusCode::INVALID_ARGUMENT) << method;
    EXPECT_THAT(status.error_message(), HasSubstr("Request:")) << method;
  }
}

TEST_F(Rubbish, HalfASceneIsInvalid) {
  v1::LoadSceneRequest request;
  request.set_name("half");
  *request.mutable_scene() = test::BallScene();
  const std::string whole = request.SerializeAsString();
  const grpc::Slice half(whole.substr(0, whole.size() / 2));
  grpc::ClientContext context;
  const auto status = Send("LoadScene", grpc::ByteBuffer(&half, 1), context);
  EXPECT_EQ(status.error_code(), StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), StartsWith("LoadSceneRequest"));
}

TEST_F(Rubbish, AScenesEmptyMessagesAreCountedToo) {
  ServerOptions options;
  options.limits.max_scene_messages = 1000;
  test::RunningServer running(options);
  v1::LoadSceneRequest request;
  request.set_name("many");
  for (int i = 0; i < 1000; ++i) request.mutable_scene()->add_objects();
  grpc::ClientContext context;
  v1::SceneInfo info;
  const auto status = running.stub().LoadScene(&context, request, &info);
  EXPECT_EQ(status.error_code(), StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(), StartsWith("scene: "));
}

TEST_F(Rubbish, LargeRequestsOfSmallMethodsAreRefused) {
  Request request = test::SmallFrame();
  request.set_camera_name(std::string(2 << 20, 'x'));
  grpc::ClientContext context;
  const auto stream = stub().RenderFrame(&context, request);
  const auto status = stream->Finish();
  EXPECT_EQ(status.error_code(), StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(), StartsWith("RenderFrameRequest"));
}

TEST_F(Rubbish, RefusalsForGoodAreNotWorthRepeating) {
  Request request = test::SmallFrame(16384, 16384);
  grpc::ClientContext context;
  const auto stream = stub().RenderFrame(&context, request);
  EXPECT_EQ(stream->Finish().error_code(), StatusCode::RESOURCE_EXHAUSTED);
  const auto& trailers = context.GetServerTrailingMetadata();
  const auto hint = trailers.find("grpc-retry-pushback-ms");
  ASSERT_NE(hint, trailers.end());
  EXPECT_EQ(hint->second, "-1");
}

TEST_F(Rubbish, BytesThatAreNoHttpDoNoHarm) {
  const std::string& address = running_->server().address();
  int port = 0;
  ASSERT_TRUE(absl::SimpleAtoi(address.substr(address.rfind(':') + 1), &port));
  sockaddr_in where{};
  where.sin_family = AF_INET;
  where.sin_port = htons(static_cast<uint16_t>(port));
  where.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const std::string preface("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n");
  const std::string settings("\0\0\0\4\0\0\0\0\0", 9);
  // Announces 100 bytes of headers, then of data, and breaks off.
  const std::string half_headers("\0\0\x64\1\4\0\0\0\1\x82\x86", 11);
  const std::string half_data("\0\0\x64\0\0\0\0\0\1\0\0\0\0\x20", 14);
  for (const std::string& bytes :
       {std::string("GET / HTTP/1.1\r\n\r\n"), std::string(4096, '\xee'), preface.substr(0, 9),
        preface + settings + half_headers, preface + settings + half_data}) {
    const int s = socket(AF_INET, SOCK_STREAM, 0);
    ASSERT_EQ(connect(s, reinterpret_cast<const sockaddr*>(&where), sizeof where), 0);
    EXPECT_GT(send(s, bytes.data(), bytes.size(), MSG_NOSIGNAL), 0);
    close(s);
    running_->ExpectServing();
  }
}

}  // namespace
}  // namespace linetree
