// What the program says when it is used wrongly, and what it says of itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/client/command/program.h"

namespace linetree {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// One line, and the exit status of wrong usage.
void ExpectUsageError(const std::vector<std::string>& arguments, const std::string& part) {
  const Finished run = RunLinetree(arguments);
  EXPECT_EQ(run.exit_status, 2) << part;
  EXPECT_EQ(run.out, "");
  EXPECT_THAT(run.err, AllOf(StartsWith("linetree: "), HasSubstr(part), EndsWith("--help'\n")));
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
}

TEST(Usage, MistypedWordsGetAHint) {
  ExpectUsageError({"rendr"}, "unknown argument 'rendr'; did you mean render?");
  ExpectUsageError({"render", "--scen", "a.nff"},
                   "unknown argument '--scen'; did you mean --scene?");
  ExpectUsageError({"scene", "chek", "a"}, "did you mean check?");
  ExpectUsageError({"bench", "--nonsense"}, "unknown argument '--nonsense'; see");
}

TEST(Usage, TheHintNamesTheCommand) {
  ExpectUsageError({"scene", "convert"}, "see 'linetree scene convert --help'");
}

TEST(Usage, WhatIsMissingIsNamed) {
  ExpectUsageError({}, "subcommand is required");
  ExpectUsageError({"render", "--local"}, "--scene is required");
  ExpectUsageError({"fly", "--local", "--scene", "a.nff"}, "--path is required");
}

TEST(Usage, ValuesAreChecked) {
  const std::vector<std::string> render = {"render", "--local", "--scene", "a.nff"};
  const auto with = [&render](const std::string& flag, const std::string& value) {
    std::vector<std::string> all = render;
    all.insert(all.end(), {flag, value});
    return all;
  };
  ExpectUsageError(with("--width", "0"), "--width");
  ExpectUsageError(with("--height", "-5"), "--height");
  ExpectUsageError(with("--width", "wide"), "--width");
  ExpectUsageError(with("--epsilon", "1.5"), "--epsilon");
  ExpectUsageError(with("--epsilon", "-0.1"), "--epsilon");
  ExpectUsageError(with("--max-depth", "17"), "--max-depth");
  ExpectUsageError(with("--min-weight", "2"), "--min-weight");
  ExpectUsageError(with("--mode", "fast"), "--mode");
  ExpectUsageError(with("--judge", "nobody"), "--judge");
  ExpectUsageError(with("--layer", "alpha"), "--layer");
  ExpectUsageError(with("--frames", "0"), "--frames");
  ExpectUsageError(with("--eye", "1,2"), "expected three finite numbers x,y,z, found '1,2'");
  ExpectUsageError(with("-o", "a.gif"), "expected a name that ends with .exr or .png");
  ExpectUsageError(with("--server", "a:1"), "--local");
}

TEST(Usage, WhatBelongsToALocalCacheNeedsLocal) {
  ExpectUsageError({"render", "--scene", "a", "--threads", "2"}, "--threads requires --local");
  ExpectUsageError({"render", "--scene", "a", "--memory", "1g"}, "--memory requires --local");
}

TEST(Usage, EveryCommandExplainsItselfWithExamples) {
  const std::vector<std::vector<std::string>> commands = {{"render"},         {"fly"},
                                                          {"rays"},           {"stats"},
                                                          {"scene", "check"}, {"scene", "convert"},
                                                          {"compare"},        {"load"},
                                                          {"bench", "error"}, {"bench", "audit"},
                                                          {"bench", "peers"}, {"cache", "sim"},
                                                          {"cache", "policy"}};
  for (std::vector<std::string> command : commands) {
    std::string name = "linetree";
    for (const std::string& word : command) name += " " + word;
    command.push_back("--help");
    const Finished run = RunLinetree(command);
    EXPECT_EQ(run.exit_status, 0) << name;
    EXPECT_EQ(run.err, "");
    EXPECT_THAT(run.out, HasSubstr("Example"));
    EXPECT_THAT(run.out, HasSubstr("  " + name + " ")) << "an example of itself";
  }
}

TEST(Usage, TheLegendIsInTheHelp) {
  EXPECT_THAT(RunLinetree({"render", "--help"}).out, HasSubstr("gap (silhouette)  yellow"));
}

TEST(Usage, Version) {
  const Finished run = RunLinetree({"--version"});
  EXPECT_EQ(run.exit_status, 0);
  EXPECT_THAT(run.out, StartsWith("linetree 0."));
}

}  // namespace
}  // namespace linetree
