#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/io/camera_path.h"
#include "core/io/exr.h"
#include "tests/client/command/program.h"

namespace linetree {
namespace {

using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

std::vector<std::string> Fly(std::vector<std::string> more) {
  more.insert(more.begin(),
              {"fly", "--local", "--scene", SourceFile("scenes/face.textproto"), "--path",
               SourceFile("scenes/paths/face_walk.textproto"), "--width", "32", "--height", "24"});
  return more;
}

TEST(FlyCommand, WritesEveryFrameAndATable) {
  TempDir dir;
  const Finished run = RunLinetree(Fly({"--frames", "3", "-o", dir.File("f_%02d.exr"), "-o",
                                        dir.File("f_%02d.png"), "--stats", dir.File("s.json")}));
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(dir.Names(), UnorderedElementsAre("f_01.exr", "f_02.exr", "f_03.exr", "f_01.png",
                                                "f_02.png", "f_03.png", "s.json"));
  // A title and a line for every frame.
  EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), 4) << run.out;
  EXPECT_EQ(ReadJson(dir.File("s.json"))["frames"].size(), 3u);
}

TEST(FlyCommand, ExplainsTheLastFramesPlan) {
  const Finished run = RunLinetree(Fly({"--frames", "2", "-q", "--lanes", "simd", "--explain"}));
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("decision(s): "));
  EXPECT_EQ(RunLinetree(Fly({"--explain", "--mode", "classical"})).exit_status, 1);
}

TEST(FlyCommand, CamerasAreThoseOfThePath) {
  TempDir dir;
  ASSERT_EQ(RunLinetree(Fly({"--frames", "3", "-q", "-o", dir.File("%d.exr")})).exit_status, 0);
  const auto path = LoadCameraPath(SourceFile("scenes/paths/face_walk.textproto"));
  ASSERT_EQ(path.status(), absl::OkStatus());
  const auto cameras = SampleCameraPath(*path, 3);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(ReadExr(dir.File(std::to_string(i + 1) + ".exr"))->camera.eye,
              (*cameras)[static_cast<size_t>(i)].eye);
  }
}

TEST(FlyCommand, ManyFramesNeedANumberedName) {
  TempDir dir;
  const Finished run = RunLinetree(Fly({"--frames", "2", "-o", dir.File("f.png")}));
  EXPECT_EQ(run.exit_status, 1);
  EXPECT_THAT(run.err, HasSubstr("such as frame_%04d.png"));
  EXPECT_EQ(RunLinetree(Fly({"--frames", "1", "-o", dir.File("f.png")})).exit_status, 0);
}

TEST(FlyCommand, ErrorsInAPathSayWhere) {
  TempDir dir;
  std::ofstream(dir.File("p.textproto"))
      << "keyframes {\n  camera { fov_deg: 190 eye { z: 1 } }\n}\n";
  const Finished run =
      RunLinetree({"fly", "--local", "--scene", SourceFile("scenes/face.textproto"), "--path",
                   dir.File("p.textproto")});
  EXPECT_EQ(run.exit_status, 1);
  EXPECT_THAT(run.err, HasSubstr("p.textproto:2:12: keyframes[0].camera.fov_deg: expected"));
}

}  // namespace
}  // namespace linetree
