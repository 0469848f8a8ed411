#include "server/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace linetree {
namespace {

using testing::StartsWith;

TEST(ServerOptionsTest, DefaultsAreValidAndStayOnThisMachine) {
  EXPECT_TRUE(ValidateServerOptions({}).ok());
  EXPECT_TRUE(IsLoopback(ServerOptions().listen));
}

TEST(ServerOptionsTest, LoopbackOrNot) {
  for (const char* listen :
       {"127.0.0.1:1", "localhost:1", "[::1]:1", "unix:socket", "127.1.2.3:0"}) {
    EXPECT_TRUE(IsLoopback(listen)) << listen;
  }
  for (const char* listen :
       {"0.0.0.0:1", "[::]:1", "10.1.2.3:1", "host:1", "127.0.0.1.example.org:1", "127.0.0.1",
        "localhost.example.org:1", "127.0.0.1:1,10.1.2.3", "dns:///127.0.0.1:1", ""}) {
    EXPECT_FALSE(IsLoopback(listen)) << listen;
  }
}

struct BadOption {
  const char* flag;
  void (*spoil)(ServerOptions& options);
};

class BadOptions : public testing::TestWithParam<BadOption> {};

TEST_P(BadOptions, AreRefusedByTheNameOfTheirFlag) {
  ServerOptions options;
  GetParam().spoil(options);
  const auto status = ValidateServerOptions(options);
  EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
  EXPECT_THAT(std::string(status.message()), StartsWith(GetParam().flag));
}

using Options = ServerOptions;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const BadOption kBadOptions[] = {
    {"--policy", [](Options& o) { o.policy = "mru"; }},
    {"--record-trace", [](Options& o) { o.record_trace = "/nowhere/at/all/a.trace"; }},
    {"--audit", [](Options& o) { o.audit_share = -1e-9; }},
    {"--audit", [](Options& o) { o.audit_share = 1.5; }},
    {"--audit", [](Options& o) { o.audit_share = kNan; }},
    {"--scene",
     [](Options& o) {
       o.scenes = {{"", "a.nff"}};
     }},
    {"--scene",
     [](Options& o) {
       o.scenes = {{"a b", "a.nff"}};
     }},
    {"--scene",
     [](Options& o) {
       o.scenes = {{"a", ""}};
     }},
    {"--scene",
     [](Options& o) {
       o.scenes = {{"a", "a.nff"}, {"a", "b.nff"}};
     }},
    {"--scene-weight",
     [](Options& o) {
       o.scene_weights = {{"gone", 1}};
     }},
    {"--scene-weight",
     [](Options& o) {
       o.scenes = {{"a", "a.nff"}};
       o.scene_weights = {{"a", kNan}};
     }},
    {"--warm-up",
     [](Options& o) {
       o.warm_ups = {{"gone", "path"}};
     }},
    {"--scene-root", [](Options& o) { o.scene_root = "/gone"; }},
    {"--listen", [](Options& o) { o.listen.clear(); }},
    {"--listen", [](Options& o) { o.listen = "0.0.0.0:1"; }},
    {"--listen",
     [](Options& o) {
       o.listen = "0.0.0.0:1";
       o.tls = {"cert", "key", ""};
     }},
    {"--listen",
     [](Options& o) {
       o.listen = "0.0.0.0:1";
       o.token_file = "tokens";
     }},
    {"--http", [](Options& o) { o.http = "0.0.0.0:1"; }},
    {"--http", [](Options& o) { o.http = "noport"; }},
    {"--tls-cert", [](Options& o) { o.tls.cert = "cert"; }},
    {"--tls-cert", [](Options& o) { o.tls.key = "key"; }},
    {"--tls-client-ca", [](Options& o) { o.tls.client_ca = "ca"; }},
    {"--threads", [](Options& o) { o.threads = -1; }},
    {"--threads", [](Options& o) { o.threads = 100'000; }},
    {"--render-slots", [](Options& o) { o.render_slots = 0; }},
    {"--memory", [](Options& o) { o.memory_bytes = 1000; }},
    {"--epsilon", [](Options& o) { o.defaults.max_relative_error = kNan; }},
    {"--max-depth", [](Options& o) { o.defaults.limits.max_depth = 17; }},
    {"--min-weight", [](Options& o) { o.defaults.limits.min_weight = -1; }},
    {"--max-stall-s", [](Options& o) { o.max_stall_s = std::chrono::seconds(-1); }},
    {"--max-flight-s", [](Options& o) { o.max_flight_s = std::chrono::seconds(-1); }},
    {"--drain-timeout-ms", [](Options& o) { o.drain_timeout_ms = std::chrono::milliseconds(-1); }},
};
INSTANTIATE_TEST_SUITE_P(All, BadOptions, testing::ValuesIn(kBadOptions));

TEST(ServerOptionsTest, OtherMachinesComeInByTlsAndTokenOrWhenToldSo) {
  Options options;
  options.listen = options.http = "0.0.0.0:1";
  options.insecure = true;
  EXPECT_TRUE(ValidateServerOptions(options).ok());
  options.insecure = false;
  EXPECT_FALSE(ValidateServerOptions(options).ok());
  options.tls = {"cert", "key", ""};
  options.token_file = "tokens";
  EXPECT_TRUE(ValidateServerOptions(options).ok()) << ValidateServerOptions(options);
}

TEST(ServerOptionsTest, SceneFlagsAreNameAndFile) {
  const auto scene = ParseSceneFlag("room=scenes/a=b.nff");
  ASSERT_TRUE(scene.ok()) << scene.status();
  EXPECT_EQ(scene->name, "room");
  EXPECT_EQ(scene->path, "scenes/a=b.nff");
  EXPECT_TRUE(absl::IsInvalidArgument(ParseSceneFlag("room").status()));
  EXPECT_THAT(std::string(ParseSceneFlag("room", "--warm-up").status().message()),
              StartsWith("--warm-up:"));
  EXPECT_EQ(ParseWeightFlag("room=2.5")->weight, 2.5);
  for (const char* flag : {"room", "room=", "room=x"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(ParseWeightFlag(flag).status())) << flag;
  }
}

}  // namespace
}  // namespace linetree
