// Every request message, as bytes and as Protobuf text, against the server without its sockets:
// whatever comes, it is an answer or an error, and the server goes on.
#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>
#include <spdlog/logger.h>

#include "server/backend.h"
#include "server/log_capture.h"
#include "server/messages.h"
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
  if (request.scene() != "ball") Check(TheBackend().UnloadScene(request).status());
}
void Handle(const v1::RenderFrameRequest& request) {
  const auto frame = TheBackend().PrepareFrame(request, "");
  Check(frame.status());
  if (frame.ok()) Check(TheBackend().Render(*frame, CancelToken()).status());
}
void Handle(const v1::FlyRequest& request) { Handle(request.frame()); }
void Handle(const v1::TraceRaysRequest& request) {
  FrameTimer timer;
  Check(TheBackend().TraceRays(request, CancelToken(), timer).status());
}
void Handle(const v1::GetStatsRequest& request) { Check(TheBackend().GetStats(request).status()); }
void Handle(const v1::UpdateSceneRequest& request) {
  if (request.scene() != "ball") Check(TheBackend().UpdateScene(request, CancelToken()).status());
}
void Handle(const v1::TuneCacheRequest& request) {
  Check(TheBackend().TuneCache(request).status());
}
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
    Parse(bytes, TheBackend().limits().max_request_bytes, &request).IgnoreError();
  }
  Handle(std::move(request));
}

using Feeder = void (*)(bool is_text, const std::string& input);
constexpr Feeder kFeeders[] = {
    Feed<v1::LoadSceneRequest>,   Feed<v1::ListScenesRequest>,  Feed<v1::DescribeSceneRequest>,
    Feed<v1::UnloadSceneRequest>, Feed<v1::RenderFrameRequest>, Feed<v1::FlyRequest>,
    Feed<v1::TraceRaysRequest>,   Feed<v1::GetStatsRequest>,    Feed<v1::GetLimitsRequest>,
    Feed<v1::UpdateSceneRequest>, Feed<v1::TuneCacheRequest>};

void LoadBallOnce() {
  static const bool loaded = [] {
    CaptureLibraryLogs(std::make_shared<spdlog::logger>("no sinks"));
    v1::LoadSceneRequest request;
    request.set_name("ball");
    request.set_text(SeedFiles("tests/system", ".textproto").at(0));
    return TheBackend().LoadScene(std::move(request)).ok();
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
        jpeg_quality: 80)"},
    {'4', R"(scene: "ball" width: 9 height: 12 camera { eye { y: 3 z: 8 } look_at { y: 1 }
        up { y: 1 } fov_deg: 40 } options { judge: JUDGE_CERTIFIED min_weight: 0.5 })"},
    {'5', R"(sequence: 9 pacing: PACING_NEWEST while_moving { divisor: 2 max_relative_error: 0.5 }
        resume_token: "x" frame { scene: "ball" width: 5 height: 5 })"},
    {'6', R"(scene: "ball" rays { origin { y: 3 z: 8 } direction { z: -1 } }
        rays { origin { x: 1 } direction { x: -1 y: 0.5 } } options { max_relative_error: 0 })"},
    {'7', R"(scene: "ball")"},
    {'8', ""},
    {'9', R"(scene: "d")"},
    {':', R"(scene: "ball" policy: "lru")"},
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
  const bool is_text = data[0] >= '0' && data[0] <= ':';
  const size_t type = static_cast<size_t>(is_text ? data[0] - '0' : data[0] % 32 - 1);
  if (type < std::size(kFeeders)) kFeeders[type](is_text, input);
  return 0;
}
