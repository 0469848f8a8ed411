#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/client/command/program.h"

namespace linetree {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::vector<std::string> BenchPeers(std::vector<std::string> more) {
  std::vector<std::string> words = {"bench",  "peers", "--repeat",  "1",
                                    "--size", "48x32", "--threads", "1"};
  for (std::string& word : more) words.push_back(std::move(word));
  return words;
}

// The folders that programs are looked for in, while it lives.
class Path {
 public:
  explicit Path(const std::string& value) : before_(std::getenv("PATH")) {
    setenv("PATH", value.c_str(), 1);
  }
  ~Path() { setenv("PATH", before_.c_str(), 1); }
  Path(const Path&) = delete;
  Path& operator=(const Path&) = delete;

 private:
  const std::string before_;
};

TEST(BenchPeersCommand, ComparesThePicturesOfAllThatAreThere) {
  TempDir dir;
  const Finished run =
      RunLinetree(BenchPeers({"--scene", SourceFile("scenes/peak.textproto"), "--scene",
                              SourceFile("scenes/gap.textproto"), "--json", dir.File("p.json"),
                              "--pictures", dir.path().string()}));
  ASSERT_EQ(run.exit_status, 0) << run.out << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("peak, 48 x 32, 1 picture each\n"),
                             HasSubstr("gap, 48 x 32, 1 picture each\n"), HasSubstr("ns/pixel")));
  EXPECT_TRUE(std::filesystem::exists(dir.File("gap_classical.png")));
  const auto json = ReadJson(dir.File("p.json"));
  ASSERT_EQ(json["scenes"].size(), 2u);
  const auto& peers = json["scenes"][1]["peers"];
  EXPECT_EQ(peers[0]["peer"], "classical");
  EXPECT_GT(peers[0]["ns_per_pixel"]["median"], 0);
  for (const auto& peer : peers) {
    if (peer.contains("error")) continue;
    EXPECT_EQ(peer["seconds"].size(), 1u) << peer;
    // Tachyon ends paths with the background; the others compute the same model.
    if (peer["peer"] == "tachyon") continue;
    EXPECT_LE(peer["difference"]["share_beyond_1_255"], 0.01) << peer;
  }
}

TEST(BenchPeersCommand, RendersWithOneThreadAndWithMore) {
  const Finished run =
      RunLinetree({"bench", "peers", "--repeat", "1", "--size", "16x16", "--threads", "3", "--peer",
                   "classical", "--scene", SourceFile("scenes/peak.textproto")});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, testing::ContainsRegex("\nclassical +[0-9.]+ +1 "));
  EXPECT_THAT(run.out, testing::ContainsRegex("\nclassical +[0-9.]+ +3 "));
  EXPECT_THAT(run.out, Not(HasSubstr("povray")));
}

TEST(BenchPeersCommand, NamesThePackageOfWhatIsNotInstalled) {
  TempDir empty;
  const Path path(empty.path().string());
  const Finished run = RunLinetree(
      BenchPeers({"--peer", "povray,tachyon", "--scene", SourceFile("scenes/peak.textproto")}));
  EXPECT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("povray: not installed: install the package povray\n"));
  EXPECT_THAT(run.out, HasSubstr("tachyon: not installed: install the package tachyon\n"));
}

TEST(BenchPeersCommand, AFailureEndsWithOneAndTheLastLines) {
  TempDir fakes;
  std::ofstream(fakes.File("povray"))
      << "#!/bin/sh\n[ \"$1\" = --version ] && exit 0\necho out of paint >&2\nexit 4\n";
  ASSERT_EQ(chmod(fakes.File("povray").c_str(), 0700), 0);
  const Path path(fakes.path().string() + ":" + std::getenv("PATH"));
  const Finished run =
      RunLinetree(BenchPeers({"--peer", "povray", "--scene", SourceFile("scenes/peak.textproto")}));
  EXPECT_EQ(run.exit_status, 1);
  EXPECT_THAT(run.out, HasSubstr("povray: povray ended with status 4: out of paint\n"));
  EXPECT_THAT(run.out, testing::ContainsRegex("\nclassical +[0-9.]+ +1 "));
  EXPECT_EQ(run.err, "linetree: peak: povray ended with status 4: out of paint\n");
}

TEST(BenchPeersCommand, SaysWhatASceneCannotBeSaidIn) {
  TempDir dir;
  std::ofstream(dir.File("odd.textproto"))
      << "materials { name: \"m\" diffuse { r: 0.5 } specular { r: 0.5 g: 0.1 } }\n"
         "lights { point { position { y: 4 } fade_distance: 3 fade_power: 1.5 } }\n"
         "objects { material: \"m\" sphere { center { } radius: 1 } }\n"
         "cameras { eye { z: 5 } look_at { } }\n";
  const Finished run =
      RunLinetree(BenchPeers({"--peer", "povray,tachyon", "--scene", dir.File("odd.textproto")}));
  EXPECT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("povray: POV-Ray cannot express material 'm'"));
  EXPECT_THAT(run.out, HasSubstr("tachyon: Tachyon cannot express light"));
}

TEST(BenchPeersCommand, ChecksItsFlags) {
  EXPECT_EQ(RunLinetree(BenchPeers({"--size", "12"})).exit_status, 2);
  EXPECT_EQ(RunLinetree(BenchPeers({"--size", "0x4"})).exit_status, 2);
  EXPECT_EQ(RunLinetree(BenchPeers({"--peer", "nobody"})).exit_status, 2);
  EXPECT_EQ(RunLinetree(BenchPeers({"--repeat", "0"})).exit_status, 2);
  const Finished missing = RunLinetree(BenchPeers({"--scene", "missing.textproto"}));
  EXPECT_EQ(missing.exit_status, 1);
  EXPECT_THAT(missing.err, HasSubstr("missing.textproto"));
  const Finished nowhere = RunLinetree(BenchPeers({"--json", "no/such/folder/p.json"}));
  EXPECT_EQ(nowhere.exit_status, 1);
  EXPECT_THAT(nowhere.err, HasSubstr("no folder"));
}

}  // namespace
}  // namespace linetree
