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

std::vector<std::string> LinesOf(const std::string& file) {
  std::vector<std::string> lines;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST(LoadCommand, CountsEveryFrameOfEveryClient) {
  TempDir dir;
  const Finished run = RunLinetree(Load({"--width", "24", "--clients", "3", "--frames", "4",
                                         "--stats", dir.File("l.json"), "-o", dir.File("l.svg")}));
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("clients     3"));
  EXPECT_THAT(run.out, HasSubstr("latency"));
  const nlohmann::json json = ReadJson(dir.File("l.json"));
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
  const nlohmann::json json = ReadJson(dir.File("l.json"));
  EXPECT_LT(json["frames"], 100000000);
}

TEST(LoadCommand, AServersFramesAreTakenApart) {
  const ServerProcess server({"--scene", "gap=" + SourceFile("scenes/gap.textproto")});
  TempDir dir;
  const std::string path = SourceFile("scenes/paths/face_walk.textproto");
  const std::vector<std::string> load = {
      "load", "--server", server.address(),  "--scene",   "gap", "--width",  "24", "--height",
      "24",   "--paths",  path + "," + path, "--clients", "3",   "--frames", "4",  "--overlap",
      "0.5",  "-q"};
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.begin(), load.begin(), load.end());
    return RunLinetree(more);
  };
  const std::string stats = dir.File("l.json");
  Finished ended = run({"--warm-up", "2", "--stats", stats, "--csv", dir.File("l.csv"), "--html",
                        dir.File("l.html"), "--objective", "refused=0"});
  ASSERT_EQ(ended.exit_status, 0) << ended.err;
  nlohmann::json json = ReadJson(stats);
  EXPECT_EQ(json["frames"], 12);
  EXPECT_EQ(json["warm_up"]["frames"], 6);
  EXPECT_GT(json["warm_up"]["cells_built"], 0);
  EXPECT_GT(json["wire_bytes"], 12 * 24 * 24 * 3 * 4);
  EXPECT_GT(json["render_ms"]["p50"], 0.0);
  EXPECT_GT(json["encode_ms"]["p50"], 0.0);
  EXPECT_LE(json["render_ms"]["max"], json["latency_ms"]["max"]);
  EXPECT_EQ(LinesOf(dir.File("l.csv")).size(), 1u + 6 + 12);
  EXPECT_THAT(LinesOf(dir.File("l.html")), testing::Contains(HasSubstr("<svg")));

  // Against itself, with an objective that nothing reaches; frames begin as a plan says.
  ended = run({"--rate", "1000", "--arrivals", "poisson", "--compare", stats, "--stats", stats,
               "--objective", "p99_ms=0"});
  EXPECT_EQ(ended.exit_status, 3) << ended.err;
  json = ReadJson(stats);
  EXPECT_EQ(json["frames"], 12);
  EXPECT_TRUE(json["compared"].contains("p99_ms"));
  EXPECT_EQ(json["objectives"][0]["met"], false);

  ended = run({"--stream", "--stats", stats});
  EXPECT_EQ(ended.exit_status, 0) << ended.err;
  json = ReadJson(stats);
  EXPECT_EQ(json["frames"], 12);
  EXPECT_GT(json["render_ms"]["p50"], 0.0);
}

TEST(LoadCommand, AFailingFrameEndsIt) {
  const Finished run = RunLinetree(Load({"--width", "1000000"}));
  EXPECT_EQ(run.exit_status, 1);
  EXPECT_THAT(run.err, HasSubstr("width"));
}

TEST(LoadCommand, ItsFlagsAreChecked) {
  Finished run = RunLinetree(Load({"--objective", "p99_ms=1", "--objective", "speed=1"}));
  EXPECT_EQ(run.exit_status, 2);
  EXPECT_THAT(run.err, HasSubstr("expected one of frames_per_s, p50_ms"));
  run = RunLinetree(Load({"--rate", "100000", "--duration", "100000"}));
  EXPECT_EQ(run.exit_status, 1);
  EXPECT_THAT(run.err, HasSubstr("at most 1e+07 frames"));
  EXPECT_EQ(RunLinetree(Load({"--rate", "10", "--stream"})).exit_status, 2);
  run = RunLinetree(Load({"--compare", SourceFile("scenes/face.textproto")}));
  EXPECT_EQ(run.exit_status, 1);
  EXPECT_THAT(run.err, HasSubstr("expected what 'load --stats' writes"));
}

}  // namespace
}  // namespace linetree
