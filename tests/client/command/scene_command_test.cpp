#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "core/io/load_scene.h"
#include "tests/client/command/program.h"

namespace linetree {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string Content(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(SceneCommand, CheckSummarises) {
  const Finished run = RunLinetree({"scene", "check", SourceFile("scenes/gap.textproto")});
  EXPECT_EQ(run.exit_status, 0) << run.err;
  const auto scene = LoadSceneFile(SourceFile("scenes/gap.textproto"));
  ASSERT_EQ(scene.status(), absl::OkStatus());
  EXPECT_THAT(run.out, AllOf(HasSubstr("gap.textproto: OK"), HasSubstr("objects    3"),
                             HasSubstr("materials  3"), HasSubstr("lights     1"),
                             HasSubstr("cameras    1: 'front'"), HasSubstr("bounds     (-3, "),
                             HasSubstr("version    " + (*scene)->version)));
}

TEST(SceneCommand, CheckGoesOnAfterABadFile) {
  TempDir dir;
  std::ofstream(dir.File("bad.nff")) << "v\nfrom 0 0 nowhere\n";
  const Finished run =
      RunLinetree({"scene", "check", dir.File("bad.nff"), SourceFile("scenes/spd/balls_2.nff")});
  EXPECT_EQ(run.exit_status, 1);
  EXPECT_THAT(run.err, StartsWith("linetree: " + dir.File("bad.nff") + ":2:"));
  EXPECT_THAT(run.out, HasSubstr("balls_2.nff: OK"));
}

TEST(SceneCommand, ConvertedNffIsTheSameScene) {
  TempDir dir;
  const std::string nff = SourceFile("scenes/spd/balls_2.nff");
  const Finished run = RunLinetree({"scene", "convert", nff, "-o", dir.File("b.textproto")});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  const auto before = LoadSceneFile(nff);
  const auto after = LoadSceneFile(dir.File("b.textproto"));
  ASSERT_EQ(after.status(), absl::OkStatus());
  EXPECT_EQ((*after)->version, (*before)->version);
}

TEST(SceneCommand, ConvertsToPovWithTheViewAsked) {
  TempDir dir;
  const std::string scene = SourceFile("scenes/gap.textproto");
  ASSERT_EQ(RunLinetree({"scene", "convert", scene, "-o", dir.File("a.pov")}).exit_status, 0);
  EXPECT_THAT(Content(dir.File("a.pov")), HasSubstr("camera"));
  ASSERT_EQ(RunLinetree({"scene", "convert", scene, "-o", dir.File("b.pov"), "--eye", "9,8,7"})
                .exit_status,
            0);
  EXPECT_NE(Content(dir.File("a.pov")), Content(dir.File("b.pov")));
}

TEST(SceneCommand, StandardOutputNeedsAFormat) {
  const std::string scene = SourceFile("scenes/gap.textproto");
  const Finished without = RunLinetree({"scene", "convert", scene, "-o", "-"});
  EXPECT_EQ(without.exit_status, 2);
  EXPECT_THAT(without.err, HasSubstr("or --to"));
  const Finished with = RunLinetree({"scene", "convert", scene, "-o", "-", "--to", "textproto"});
  EXPECT_EQ(with.exit_status, 0);
  EXPECT_THAT(with.out, HasSubstr("name: \"gap\""));
}

TEST(SceneCommand, ABadSceneIsNotConverted) {
  TempDir dir;
  std::ofstream(dir.File("bad.textproto")) << "objects { name: \"o\" }";
  const Finished run =
      RunLinetree({"scene", "convert", dir.File("bad.textproto"), "-o", dir.File("out.pov")});
  EXPECT_EQ(run.exit_status, 1);
  EXPECT_THAT(run.err, HasSubstr("bad.textproto:1:"));
  EXPECT_FALSE(std::filesystem::exists(dir.File("out.pov")));
}

}  // namespace
}  // namespace linetree
