#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/client/command/program.h"

namespace linetree {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::vector<std::string> BenchError(std::vector<std::string> more) {
  more.insert(more.begin(),
              {"bench", "error", "--local", "--scene", SourceFile("scenes/peak.textproto"),
               "--width", "24", "--height", "24", "--repeat", "1"});
  return more;
}

TEST(BenchCommand, ErrorPrintsATable) {
  const Finished run = RunLinetree(BenchError({"--epsilons", "0,0.25,1"}));
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, StartsWith("epsilon,classical_ms,cold_ms,warm_ms,cold_success,"));
  EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), 4);
}

TEST(BenchCommand, ErrorWritesTableAndPlot) {
  TempDir dir;
  const Finished run = RunLinetree(
      BenchError({"--epsilons", "0.5", "-o", dir.File("e.csv"), "-o", dir.File("e.svg")}));
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_EQ(run.out, "");
  std::ostringstream svg;
  svg << std::ifstream(dir.File("e.svg")).rdbuf();
  EXPECT_THAT(svg.str(), HasSubstr("run time"));
  EXPECT_THAT(svg.str(), HasSubstr("relative error"));
  std::string title;
  std::ifstream csv(dir.File("e.csv"));
  std::getline(csv, title);
  EXPECT_THAT(title, StartsWith("epsilon,"));
}

TEST(BenchCommand, EpsilonsAreChecked) {
  EXPECT_EQ(RunLinetree(BenchError({"--epsilons", "0,2"})).exit_status, 2);
  EXPECT_EQ(RunLinetree(BenchError({"--epsilons", "a"})).exit_status, 2);
}

}  // namespace
}  // namespace linetree
