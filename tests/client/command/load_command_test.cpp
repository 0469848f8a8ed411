#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/client/command/program.h"

namespace linetree {
namespace {

using ::testing::HasSubstr;

std::vector<std::string> Load(std::vector<std::string> more) {
  more.insert(more.begin(),
              {"load", "--local", "--scene", SourceFile("scenes/face.textproto"), "--path",
               SourceFile("scenes/paths/face_walk.textproto"), "--height", "24", "--epsilon", "1"});
  return more;
}

TEST(LoadCommand, CountsEveryFrameOfEveryClient) {
  TempDir dir;
  const Finished run = RunLinetree(Load({"--width", "24", "--clients", "3", "--frames", "4",
                                         "--stats", dir.File("l.json"), "-o", dir.File("l.svg")}));
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("clients     3"));
  EXPECT_THAT(run.out, HasSubstr("latency ms  p50"));
  const nlohmann::json json = nlohmann::json::parse(std::ifstream(dir.File("l.json")));
  EXPECT_EQ(json["frames"], 12);
  EXPECT_EQ(json["clients"], 3);
  EXPECT_GT(json["hit_rate"], 0.0);
  const nlohmann::json& latency = json["latency_ms"];
  EXPECT_LE(latency["p50"], latency["p90"]);
  EXPECT_LE(latency["p90"], latency["p99"]);
  EXPECT_LE(latency["p99"], latency["max"]);
  std::string svg;
  std::getline(std::ifstream(dir.File("l.svg")), svg);
  EXPECT_THAT(svg, HasSubstr("<svg"));
}

TEST(LoadCommand, ADurationEndsIt) {
  TempDir dir;
  ASSERT_EQ(RunLinetree(Load({"--width", "24", "--clients", "2", "--duration", "0.1", "--frames",
                              "100000000", "-q", "--stats", dir.File("l.json")}))
                .exit_status,
            0);
  const nlohmann::json json = nlohmann::json::parse(std::ifstream(dir.File("l.json")));
  EXPECT_LT(json["frames"], 100000000);
}

TEST(LoadCommand, AFailingFrameEndsIt) {
  const Finished run = RunLinetree(Load({"--width", "1000000"}));
  EXPECT_EQ(run.exit_status, 1);
  EXPECT_THAT(run.err, HasSubstr("width"));
}

}  // namespace
}  // namespace linetree
