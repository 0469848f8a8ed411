// Every request message, as bytes and as Protobuf text, against the server without its sockets:
// whatever comes, it is an answer or an error, and the server goes on.
#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>
#include <spdlog/logger.h>

#include <algorithm>

#include "server/backend.h"
#include "server/flight_plan.h"
#include "server/log_capture.h"
#include "server/messages.h"
#include "server/resume_token.h"
#include "server/tokens.h"
#include "tests/fuzz/small_limits.h"

namespace linetree::fuzz {
namespace {

using google::protobuf::Message;

ServerOptions SmallServer() {
  ServerOptions options;
  options.threads = 1;
  options.memory_bytes = 8 << 20;
  options.limits.render = {.max_side = 24, .max_pixels = 300, .max_samples = 600, .max_rays = 50};
  options.limits.scene = SmallScenes();
  options.limits.max_scenes = 4;
  options.limits.max_scene_messages = 5000;
  options.limits.max_warm_up_frames = 3;
  options.scene_root = std::string(LINETREE_SOURCE_DIR) + "/tests/system";
  return options;
}

Backend& TheBackend() {
  static Backend backend(SmallServer(), std::make_shared<spdlog::logger>("no sinks"));
  return backend;
}

// Error texts go to people and to logs.
void Check(const absl::Status& status) {
  LT_CHECK(status.ok() || !status.message().empty());
  LT_CHECK(status.code() != absl::StatusCode::kInternal);
}

// Scenes that are always there.
bool IsOurs(const std::string& name) { return name == "ball" || name == "edited"; }

void LoadBall(const std::string& name) {
  v1::LoadSceneRequest request;
  request.set_name(name);
  request.set_text(SeedFiles("tests/system", ".textproto").at(0));
  request.set_replace(true);
  LT_CHECK(TheBackend().LoadScene(std::move(request)).ok());
}

void Handle(v1::LoadSceneRequest request) {
  const auto bytes = Serialize(request);
  if (CountMessages(bytes, request) > TheBackend().limits().max_scene_messages) return;
  request.set_replace(true);
  Check(TheBackend().LoadScene(std::move(request)).status());
}
void Handle(const v1::ListScenesRequest&) { TheBackend().ListScenes(); }
void Handle(const v1::DescribeSceneRequest& request) {
  Check(TheBackend().DescribeScene(request).status());
}
void Handle(const v1::UnloadSceneRequest& request) {
  if (!IsOurs(request.scene())) Check(TheBackend().UnloadScene(request).status());
}
void Handle(const v1::RenderFrameRequest& request) {
  const auto frame = TheBackend().PrepareFrame(request, "");
  Check(frame.status());
  if (frame.ok()) Check(TheBackend().Render(*frame, CancelToken()).status());
}
void Handle(const v1::FlyRequest& request) {
  ParseResumeToken(request.resume_token(), "resume_token").status().IgnoreError();
  for (const bool comes_first : {true, false}) {
    FlightPlan plan(3);
    if (!comes_first) plan.Add(v1::FlyRequest());
    plan.Add(request);
    while (plan.HasNext()) {
      LT_CHECK(plan.WorkOfNext() > 0);
      LT_CHECK(static_cast<int>(plan.PriorityOfNext()) < kPriorities);
      const auto step = plan.Next();
      Check(step.status());
      if (step.ok() && comes_first) Handle(step->viewpoint.frame());
    }
  }
}
void Handle(const v1::TraceRaysRequest& request) {
  FrameTimer timer;
  Check(TheBackend().TraceRays(request, CancelToken(), timer).status());
}
void Handle(const v1::GetStatsRequest& request) { Check(TheBackend().GetStats(request).status()); }
// Of a scene that is as it was at first.
void Handle(v1::UpdateSceneRequest request) {
  LoadBall("edited");
  request.set_scene("edited");
  Check(TheBackend().UpdateScene(request, CancelToken()).status());
}
void Handle(const v1::TuneCacheRequest& request) {
  Check(TheBackend().TuneCache(request).status());
}
void Handle(const v1::ExplainRequest& request) { Check(TheBackend().Explain(request).status()); }
void Handle(const v1::GetLimitsRequest&) { TheBackend().GetLimits(); }

// Reads a request in one of the two forms and hands it over. What stood before the first error is a
// request, too.
template <class Request>
void Feed(bool is_text, const std::string& input) {
  Request request;
  if (is_text) {
    google::protobuf::TextFormat::Parser parser;
    class : public google::protobuf::io::ErrorCollector {
      void AddError(int, int, const std::string&) override {}
    } quiet;
    parser.RecordErrorsTo(&quiet);
    parser.ParseFromString(input, &request);
  } else {
    const grpc::Slice slice(input);
    const grpc::ByteBuffer bytes(&slice, 1);
    CountField(bytes, 2);
    LastVarint(bytes, 4);
    CountMessages(bytes, request);
    Parse(bytes, TheBackend().limits().max_request_bytes, &request).IgnoreError();
  }
  Handle(std::move(request));
}

// What else comes as text from outside.
void FeedTexts(bool, const std::string& input) {
  const auto token = ParseResumeToken(input, "token");
  if (token.ok()) LT_CHECK(ToText(*token) == input);
  const auto tokens = Tokens::Parse(input, "tokens");
  LT_CHECK(tokens.ok() || !tokens.status().message().empty());
}

using Feeder = void (*)(bool is_text, const std::string& input);
constexpr Feeder kFeeders[] = {Feed<v1::LoadSceneRequest>,
                               Feed<v1::ListScenesRequest>,
                               Feed<v1::DescribeSceneRequest>,
                               Feed<v1::UnloadSceneRequest>,
                               Feed<v1::RenderFrameRequest>,
                               Feed<v1::FlyRequest>,
                               Feed<v1::TraceRaysRequest>,
                               Feed<v1::GetStatsRequest>,
                               Feed<v1::GetLimitsRequest>,
                               Feed<v1::UpdateSceneRequest>,
                               Feed<v1::TuneCacheRequest>,
                               Feed<v1::ExplainRequest>,
                               FeedTexts};
// The requests of the first ones, in their order.
constexpr const char* kRequests[] = {
    "LoadSceneRequest",   "ListScenesRequest",  "DescribeSceneRequest", "UnloadSceneRequest",
    "RenderFrameRequest", "FlyRequest",         "TraceRaysRequest",     "GetStatsRequest",
    "GetLimitsRequest",   "UpdateSceneRequest", "TuneCacheRequest",     "ExplainRequest"};
static_assert(std::size(kRequests) + 1 == std::size(kFeeders));

// That no method of the service has been forgotten.
void CheckEveryMethodIsFed() {
  const auto* service =
      v1::TuneCacheRequest::descriptor()->file()->FindServiceByName("RadianceCache");
  LT_CHECK(service->method_count() == static_cast<int>(std::size(kRequests)));
  for (int i = 0; i < service->method_count(); ++i) {
    const std::string& request = service->method(i)->input_type()->name();
    LT_CHECK(std::count(std::begin(kRequests), std::end(kRequests), request) == 1);
  }
}

void LoadBallOnce() {
  static const bool loaded = [] {
    CheckEveryMethodIsFed();
    CaptureLibraryLogs(std::make_shared<spdlog::logger>("no sinks"));
    LoadBall("ball");
    LoadBall("edited");
    return true;
  }();
  LT_CHECK(loaded);
}

// Texts of requests that are fine, by the number of their type.
const std::pair<char, const char*> kTexts[] = {
    {'0', R"(name: "b" text: "objects { }")"},
    {'0', R"(name: "c" format: NFF text: "b 0 0 0\nf 1 1 1 1 0 0 0 0\ns 0 0 0 1\n")"},
    {'0', R"(name: "d" scene { materials { name: "m" } lights { point { position { y: 9 } } }
        objects { material: "m" sphere { radius: 1 } }
        objects { material: "m" box { min { x: 2 } max { x: 3 y: 1 z: 1 } } }
        objects { material: "m" polygon { vertices { } vertices { x: 1 } vertices { y: 1 } } } })"},
    {'0', R"(name: "e" file: "ball.textproto" memory_weight: 0.5 warm_up { frames: 2 width: 8
        height: 8 path { keyframes { camera { eye { z: 8 } } } } })"},
    {'1', ""},
    {'2', R"(scene: "ball")"},
    {'3', R"(scene: "b")"},
    {'4', R"(scene: "ball" width: 12 height: 9 camera_name: "front" all_layers: true
        options { mode: CACHED judge: PAPER max_relative_error: 0.1 max_depth: 4 lanes: LANES_SIMD }
        sampling { samples: 4 pattern: SAMPLES_JITTERED seed: 7 } codec: CODEC_JPEG
        jpeg_quality: 80 priority: PRIORITY_BATCH)"},
    {'4', R"(scene: "ball" width: 9 height: 12 camera { eye { y: 3 z: 8 } look_at { y: 1 }
        up { y: 1 } fov_deg: 40 } options { judge: JUDGE_CERTIFIED min_weight: 0.5 })"},
    {'5', R"(sequence: 9 pacing: PACING_NEWEST while_moving { divisor: 2 max_relative_error: 0.5 }
        resume_token: "x" frame { scene: "ball" width: 5 height: 5 })"},
    {'6', R"(scene: "ball" rays { origin { y: 3 z: 8 } direction { z: -1 } }
        rays { origin { x: 1 } direction { x: -1 y: 0.5 } } options { max_relative_error: 0 }
        priority: PRIORITY_BACKGROUND)"},
    {'7', R"(scene: "ball")"},
    {'8', ""},
    {'9', R"(expected_version: "0123456789abcdef")"},
    {'9', R"(edits { move_object { object { name: "ball" } transform { translate { x: 1 } }
        transform { rotate { axis { z: 1 } angle_deg: 9 } } transform { scale { x: 2 y: 2 z: 2 } }
        transform { matrix { row_major_3x4: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 3] } } } }
        edits { set_material { object { index: 0 } material: "matte" } }
        edits { put_material { name: "new" diffuse { r: 1 } } })"},
    {'9', R"(edits { add_object { material: "matte" cone { top { y: 1 } base_radius: 1 } } }
        edits { remove_object { index: 1 } } edits { add_light { directional { direction { y: -1 } } } }
        edits { replace_light { light { index: 0 } with { point { position { y: 3 } } } } }
        edits { remove_light { index: 0 } }
        edits { replace_object { object { index: 0 } with { material: "matte" sphere { radius: 2 } } } })"},
    {':', R"(scene: "ball" policy: "lru")"},
    {';', "0123456789abcdef0123456789abcdef-7"},
    {';', "# who may call\nviewer looks-and-no-more\nadmin may-do-everything\n"},
};

}  // namespace

// The first character of an input is the number of its type, or a letter for the form of bytes.
std::vector<std::string> Seeds() {
  std::vector<std::string> seeds;
  for (const auto& [type, text] : kTexts) seeds.push_back(type + std::string(text));
  v1::RenderFrameRequest frame;
  LT_CHECK(google::protobuf::TextFormat::ParseFromString(kTexts[7].second, &frame));
  v1::LoadSceneRequest scene;
  LT_CHECK(google::protobuf::TextFormat::ParseFromString(kTexts[2].second, &scene));
  seeds.push_back("e" + frame.SerializeAsString());
  seeds.push_back("a" + scene.SerializeAsString());
  return seeds;
}

}  // namespace linetree::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace linetree::fuzz;  // NOLINT(google-build-using-namespace)
  LoadBallOnce();
  if (size == 0) return 0;
  const std::string input(reinterpret_cast<const char*>(data) + 1, size - 1);
  const bool is_text = data[0] >= '0' && data[0] <= ';';
  const size_t type = static_cast<size_t>(is_text ? data[0] - '0' : data[0] % 32 - 1);
  if (type < std::size(kFeeders)) kFeeders[type](is_text, input);
  return 0;
}
