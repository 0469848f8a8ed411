#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/client/command/program.h"

namespace linetree {
namespace {

using ::testing::HasSubstr;

std::vector<std::string> BenchRays(std::vector<std::string> more) {
  more.insert(more.begin(), {"bench", "rays", "--width", "128", "--height", "24", "--repeat", "2"});
  return more;
}

TEST(BenchRaysCommand, PrintsBothKindsOfBatches) {
  TempDir dir;
  const Finished run =
      RunLinetree(BenchRays({"--scene", SourceFile("scenes/face.textproto"), "--scene",
                             SourceFile("scenes/spd/balls_2.nff"), "--json", dir.File("r.json")}));
  ASSERT_EQ(run.exit_status, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("face     coherent"));
  EXPECT_THAT(run.out, HasSubstr("balls_2  incoherent"));
  const auto json = ReadJson(dir.File("r.json"));
  ASSERT_EQ(json["scenes"].size(), 2u);
  for (const auto& scene : json["scenes"]) {
    EXPECT_EQ(scene["coherent"]["taken"], "as given");
    EXPECT_EQ(scene["incoherent"]["taken"], "binned");
    for (const char* kind : {"coherent", "incoherent"}) {
      EXPECT_EQ(scene[kind]["beyond"], 0);
      EXPECT_EQ(scene[kind]["ns_per_ray"].size(), 5u);
      EXPECT_GT(scene[kind]["ns_per_ray"]["packets, binned"]["median"], 0);
      EXPECT_LE(scene[kind]["largest_classical_error"], scene[kind]["lane_rounding"]);
    }
  }
}

TEST(BenchRaysCommand, ChecksItsFlags) {
  EXPECT_EQ(RunLinetree(BenchRays({"--epsilon", "2"})).exit_status, 2);
  EXPECT_EQ(RunLinetree(BenchRays({"--repeat", "0"})).exit_status, 2);
  EXPECT_NE(RunLinetree(BenchRays({"--scene", "missing.nff"})).exit_status, 0);
  EXPECT_NE(RunLinetree(BenchRays({"--scenes", "nowhere"})).exit_status, 0);
}

}  // namespace
}  // namespace linetree
