#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/client/command/program.h"

namespace linetree {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// Small and quick; `more` overrides nothing.
Finished BenchSpeed(std::vector<std::string> more, const std::string& side = "32") {
  std::vector<std::string> words = {"bench",    "speed", "--width",  side, "--height", side,
                                    "--repeat", "1",     "--frames", "2",  "--flight", "3"};
  for (std::string& word : more) words.push_back(std::move(word));
  return RunLinetree(words);
}

TEST(BenchSpeedCommand, ComparesTheTracers) {
  TempDir dir;
  const Finished run =
      RunLinetree({"bench", "speed", "--scene", SourceFile("scenes/peak.textproto"), "--width",
                   "33", "--height", "21", "--repeat", "1", "--json", dir.File("s.json")});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("other trees"));
  const auto json = ReadJson(dir.File("s.json"));
  ASSERT_EQ(json["scenes"].size(), 1u);
  const auto& scene = json["scenes"][0];
  EXPECT_EQ(scene["pixels"], 693);
  EXPECT_EQ(scene["different_topology"], 0);
  EXPECT_GT(scene["packet_ns_per_pixel"]["median"], 0);
  ASSERT_EQ(scene["paths"].size(), 2u);
  EXPECT_EQ(scene["paths"][0]["path"], "cold");
  EXPECT_EQ(scene["paths"][1]["turns"].size(), 5u);
}

TEST(BenchSpeedCommand, FliesEveryPath) {
  TempDir dir;
  const Finished run = BenchSpeed({"--made", "room:18:4", "--path", "walk", "--path", "teleport",
                                   "--path", "cold", "--json", dir.File("s.json")});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  const auto paths = ReadJson(dir.File("s.json"))["scenes"][0]["paths"];
  ASSERT_EQ(paths.size(), 3u);
  EXPECT_EQ(paths[0]["path"], "walk");
  EXPECT_EQ(paths[0]["frames"], 3);
  EXPECT_EQ(paths[0]["pixels"], 3 * 32 * 32);
  EXPECT_EQ(paths[1]["path"], "teleport");
  EXPECT_EQ(paths[1]["turns"].size(), 3u);
  EXPECT_EQ(paths[2]["path"], "cold");
  for (const auto& path : paths) {
    EXPECT_EQ(path["beyond"], 0);
    EXPECT_LE(path["p999_error"], path["largest_error"]);
    uint64_t bytes = 0;
    for (const auto& part : path["memory"]) bytes += part["bytes"].get<uint64_t>();
    EXPECT_GT(bytes, 0u);
    EXPECT_EQ(path["bytes"], bytes);
  }
}

TEST(BenchSpeedCommand, WalksAlongAPath) {
  TempDir dir;
  const Finished run =
      BenchSpeed({"--scene", SourceFile("scenes/room.textproto"), "--path", "walk", "--walk",
                  SourceFile("scenes/paths/room_walk.textproto"), "--json", dir.File("s.json")});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_EQ(ReadJson(dir.File("s.json"))["scenes"][0]["paths"][0]["frames"], 3);
  EXPECT_NE(BenchSpeed({"--made", "room:18:1", "--walk", "nowhere.textproto"}).exit_status, 0);
}

TEST(BenchSpeedCommand, SweepsAndDrawsThem) {
  TempDir dir;
  const Finished run = BenchSpeed(
      {"--made", "room:18:1", "--scene", SourceFile("scenes/peak.textproto"), "--sweep", "lights",
       "--points", "2,5", "--path", "warm", "--svg", dir.File("."), "--json", dir.File("s.json")});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("over lights"));
  const auto json = ReadJson(dir.File("s.json"));
  ASSERT_EQ(json["sweeps"].size(), 1u);
  EXPECT_EQ(json["sweeps"][0]["sweep"], "lights");
  const auto& rows = json["sweeps"][0]["rows"];
  ASSERT_EQ(rows.size(), 4u);  // two scenes at two points
  EXPECT_EQ(rows[0]["point"], 2);
  EXPECT_EQ(rows[3]["point"], 5);
  for (const auto& row : rows) EXPECT_EQ(row["lights"], row["point"]) << row["scene"];
  std::stringstream svg;
  svg << std::ifstream(dir.File("lights.svg")).rdbuf();
  EXPECT_THAT(svg.str(), StartsWith("<svg"));
  EXPECT_THAT(svg.str(), HasSubstr("room:18:N warm"));
  EXPECT_THAT(svg.str(), HasSubstr("peak classical"));
}

TEST(BenchSpeedCommand, SweepsOneAfterTheOther) {
  TempDir dir;
  const Finished run = BenchSpeed({"--made", "glass:18:1", "--sweep", "depth", "--sweep", "epsilon",
                                   "--path", "cold", "--json", dir.File("s.json")},
                                  "16");
  ASSERT_EQ(run.exit_status, 0) << run.err;
  const auto json = ReadJson(dir.File("s.json"));
  ASSERT_EQ(json["sweeps"].size(), 2u);
  for (const auto& row : json["sweeps"][0]["rows"]) EXPECT_EQ(row["max_depth"], row["point"]);
  for (const auto& row : json["sweeps"][1]["rows"]) EXPECT_EQ(row["epsilon"], row["point"]);
  EXPECT_EQ(json["sweeps"][1]["rows"][0]["paths"][0]["largest_error"], 0);
}

TEST(BenchSpeedCommand, StagesAndReasonsArePrintedWhenAskedFor) {
  TempDir dir;
  const Finished run = BenchSpeed(
      {"--made", "room:18:8", "--stages", "--explain", "--json", dir.File("s.json")}, "64");
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("branches"));
  EXPECT_THAT(run.out, HasSubstr("Surface trees after "));
  const auto stages = ReadJson(dir.File("s.json"))["scenes"][0]["stages_ns_per_pixel"];
  EXPECT_GT(stages["eye"], 0);
  EXPECT_GT(stages["cold_learning"]["learn"], 0);
}

// What is missed is reported, and is no failure.
TEST(BenchSpeedCommand, TargetsAreAReport) {
  TempDir dir;
  const Finished run =
      BenchSpeed({"--targets", "--target-scenes", "room:18:3", "--json", dir.File("t.json")});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("to reach"));
  const auto targets = ReadJson(dir.File("t.json"))["targets"];
  ASSERT_EQ(targets.size(), 4u);
  for (const auto& target : targets) {
    EXPECT_EQ(target["scene"], "room:18:3");
    EXPECT_EQ(target["met"], target["measured"] >= target["goal"]);
    EXPECT_EQ(target["beyond"], 0);
    const auto& roof = target["roofline"];
    const double kept =
        roof["eye_ns_per_pixel"].get<double>() + roof["branches_ns_per_pixel"].get<double>();
    EXPECT_DOUBLE_EQ(roof["best"], roof["classical_ns_per_pixel"].get<double>() / kept);
  }
  EXPECT_THAT(run.out, HasSubstr("without lights"));
  EXPECT_EQ(targets[0]["goal"], 2.5);
}

TEST(BenchSpeedCommand, ChecksItsFlags) {
  EXPECT_EQ(BenchSpeed({"--sweep", "colours"}).exit_status, 2);
  EXPECT_EQ(BenchSpeed({"--path", "sideways"}).exit_status, 2);
  EXPECT_EQ(BenchSpeed({"--points", "1,2"}).exit_status, 2);
  EXPECT_EQ(BenchSpeed({"--sweep", "lights", "--sweep", "depth", "--points", "1"}).exit_status, 2);
  EXPECT_EQ(BenchSpeed({"--sweep", "lights", "--points", "1,x"}).exit_status, 2);
  EXPECT_EQ(BenchSpeed({"--sweep", "lights", "--targets"}).exit_status, 2);
  EXPECT_EQ(BenchSpeed({"--sweep", "lights", "--points", "0.5"}).exit_status, 1);
  EXPECT_EQ(BenchSpeed({"--sweep", "depth", "--points", "99"}).exit_status, 1);
  EXPECT_EQ(BenchSpeed({"--sweep", "objects", "--scene", SourceFile("scenes/peak.textproto")})
                .exit_status,
            1);
  EXPECT_EQ(BenchSpeed({"--made", "cave:1:1"}).exit_status, 1);
  EXPECT_EQ(BenchSpeed({"--sweep", "lights", "--svg", "/nowhere/at/all"}).exit_status, 1);
}

}  // namespace
}  // namespace linetree
