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

TEST(BenchCommand, AccuracyCountsPixelsBeyondEpsilon) {
  TempDir dir;
  const Finished run =
      RunLinetree({"bench", "accuracy", "--scene", SourceFile("scenes/peak.textproto"), "--width",
                   "96", "--height", "96", "--epsilons", "0.5,0.1", "--json", dir.File("a.json")});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("of 36,864 pixels beyond epsilon"));
  const auto json = ReadJson(dir.File("a.json"));
  ASSERT_EQ(json.size(), 2u);
  EXPECT_EQ(json[0]["pixels"], 9216);
  EXPECT_GT(json[0]["warm"]["success"], 0);
  EXPECT_EQ(json[1]["epsilon"], 0.1);
}

TEST(BenchCommand, PaperPrintsItsTablesAsTextAndJson) {
  TempDir dir;
  const Finished run = RunLinetree({"bench", "paper", "--scenes", SourceFile("scenes"), "--width",
                                    "48", "--height", "48", "--json", dir.File("p.json")});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("Table 1: face, epsilon 0.25"));
  EXPECT_THAT(run.out, HasSubstr("Table 3: room, first frame, epsilon 0.00"));
  const auto json = ReadJson(dir.File("p.json"));
  EXPECT_EQ(json["tables"].size(), 8u);
  EXPECT_EQ(json["tables"][2]["rows"].size(), 5u);
  EXPECT_EQ(json["tables"][2]["rows"][0]["printed"]["success"], 0.76);
}

TEST(BenchCommand, ReportIsAPageThatGoesOnWhereItWas) {
  TempDir dir;
  const auto report = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"bench", "report", "--quick", "--scenes", SourceFile("scenes"), "-o",
                               dir.File("report"), "--threads", "2"});
    return RunLinetree(more);
  };
  const Finished first = report({"--section", "edit"});
  ASSERT_EQ(first.exit_status, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("pixels beyond epsilon after edits"));
  EXPECT_THAT(first.out, HasSubstr("1 sections, of which 0 were there"));
  const Finished again = report({"--section", "edit"});
  ASSERT_EQ(again.exit_status, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("1 sections, of which 1 were there"));
  std::ifstream file(dir.File("report/report.html"));
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  EXPECT_THAT(page, HasSubstr("<polyline"));
  EXPECT_THAT(page, HasSubstr("linetree bench edit --made"));
  EXPECT_EQ(report({"--section", "nothing"}).exit_status, 2);
}

std::vector<std::string> BenchAudit(std::vector<std::string> more) {
  std::vector<std::string> words = {"bench", "audit", "--threads", "2"};
  for (std::string& word : more) words.push_back(std::move(word));
  return words;
}

TEST(BenchCommand, AuditFindsNothingInCertifiedAnswers) {
  TempDir dir;
  const Finished run = RunLinetree(
      BenchAudit({"--queries", "6000", "--family", "walls", "--family", "glass", "--scene",
                  SourceFile("scenes/gap.textproto"), "--json", dir.File("audit.json")}));
  ASSERT_EQ(run.exit_status, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("gap.textproto"));
  EXPECT_THAT(run.out, HasSubstr("0 violations in "));
  const auto json = ReadJson(dir.File("audit.json"));
  EXPECT_EQ(json["rows"].size(), 12u);
  EXPECT_EQ(json["scenes"], 3);
  EXPECT_EQ(json["total"]["violations"], 0);
  EXPECT_EQ(json["judge"], "certified");
  EXPECT_TRUE(json["violations"].empty());
}

// The paper's judge is a heuristic that abutting walls deceive.
TEST(BenchCommand, AuditEndsWithOneWhenAnAnswerBreaksThePromise) {
  TempDir dir;
  const Finished run =
      RunLinetree(BenchAudit({"--queries", "300000", "--seed", "3", "--judge", "paper", "--family",
                              "walls", "--epsilon", "0.02", "--json", dir.File("audit.json")}));
  EXPECT_EQ(run.exit_status, 1) << run.out;
  EXPECT_THAT(run.out, HasSubstr("\nscene=\"walls 0x"));
  const auto json = ReadJson(dir.File("audit.json"));
  EXPECT_GT(json["total"]["violations"], 0);
  ASSERT_FALSE(json["violations"].empty());
  EXPECT_LE(json["violations"].size(), 20u);
  EXPECT_THAT(json["violations"][0]["origin"], HasSubstr("0x"));
  EXPECT_GT(json["violations"][0]["error_over_allowed"], 1);
}

TEST(BenchCommand, AuditChecksItsFlags) {
  EXPECT_EQ(RunLinetree(BenchAudit({"--epsilon", "1.5"})).exit_status, 2);
  EXPECT_EQ(RunLinetree(BenchAudit({"--family", "nonsense"})).exit_status, 2);
  EXPECT_EQ(RunLinetree(BenchAudit({"--queries", "0"})).exit_status, 2);
  EXPECT_EQ(RunLinetree(BenchAudit({"--judge", "nobody"})).exit_status, 2);
  EXPECT_NE(RunLinetree(BenchAudit({"--scene", "missing.nff"})).exit_status, 0);
}

TEST(BenchCommand, CertifyPrintsItsThreeTables) {
  TempDir dir;
  const Finished run =
      RunLinetree({"bench", "certify", "--cell-scenes", "3", "--scenes", SourceFile("scenes"),
                   "--scene", SourceFile("scenes/glass.textproto"), "--frames", "2", "--size", "64",
                   "--threads", "2", "--json", dir.File("c.json")});
  ASSERT_EQ(run.exit_status, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("Random 4D cells"));
  EXPECT_THAT(run.out, HasSubstr("Lights over "));
  EXPECT_THAT(run.out, HasSubstr("\n0 violations\n"));
  const auto json = ReadJson(dir.File("c.json"));
  ASSERT_EQ(json["cells"].size(), 10u);  // five edges in each of two families
  // Smaller cells are certified more often; what is certified is looked at.
  EXPECT_GT(json["cells"][4]["same_paths"], json["cells"][0]["same_paths"]);
  EXPECT_GT(json["cells"][4]["rays"], 1000);
  ASSERT_EQ(json["lights"].size(), 8u);  // with shadow functions and without
  EXPECT_EQ(json["lights"][7]["lights"], 128);
  EXPECT_GT(json["lights"][0]["at_most_one_undecided"], 0);
  EXPECT_GT(json["lights"][0]["on_in_no_sum"]["near"], 0);
  EXPECT_EQ(json["lights"][0]["on_in_no_sum"]["black"], 0);
  ASSERT_EQ(json["frames"].size(), 4u);
  EXPECT_EQ(json["frames"][0]["unequal"], 0);
  EXPECT_EQ(json["frames"][0]["pixels"], 3 * 64 * 64);
  EXPECT_LT(json["frames"][0]["warm_searches"], 1);
}

TEST(BenchCommand, CertifyChecksItsFlags) {
  EXPECT_EQ(RunLinetree({"bench", "certify", "--part", "nonsense"}).exit_status, 2);
  EXPECT_EQ(RunLinetree({"bench", "certify", "--epsilons", "2"}).exit_status, 2);
  EXPECT_NE(RunLinetree({"bench", "certify", "--scenes", "nowhere"}).exit_status, 0);
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

TEST(BenchPoliciesCommand, ReplaysFlightsWithEveryPolicy) {
  TempDir dir;
  const Finished run = RunLinetree({"bench",    "policies",
                                    "--scene",  SourceFile("scenes/room.textproto"),
                                    "--flight", "orbit",
                                    "--flight", "teleport",
                                    "--frames", "12",
                                    "--width",  "64",
                                    "--height", "64",
                                    "--traces", dir.File("."),
                                    "--json",   dir.File("p.json"),
                                    "--svg",    dir.File("p.svg")});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("To reach: the best policy at most 1.15 x the bound: "));
  const auto json = ReadJson(dir.File("p.json"));
  EXPECT_EQ(json["contests"].size(), 2u * 3);
  ASSERT_EQ(json["rows"].size(), 2u * 3 * 15);
  double least = 2;
  for (const auto& row : json["rows"]) {
    EXPECT_GE(row["regret"], 1 - 1e-9) << row["policy"];
    least = std::min(least, row["regret"].get<double>());
    EXPECT_GT(row["requests"], row["hits"]);
  }
  EXPECT_LT(least, 1.5);
  // The same from the trace that it has left.
  const Finished sim = RunLinetree({"cache", "sim", "--trace", dir.File("room_orbit.trace"),
                                    "--policy", "fifo", "--json", dir.File("s.json")});
  ASSERT_EQ(sim.exit_status, 0) << sim.err;
  const auto again = ReadJson(dir.File("s.json"));
  ASSERT_EQ(again.size(), 3u);
  for (size_t i = 0; i < again.size(); ++i) {
    EXPECT_EQ(json["rows"][i]["policy"], "fifo");
    EXPECT_EQ(again[i]["rebuild_ns"], json["rows"][i]["rebuild_ns"]);
  }
}

}  // namespace
}  // namespace linetree
