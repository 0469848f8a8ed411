#include "peers/run_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace linetree {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

// As a string of the standard library, which matchers take.
std::string MessageOf(const absl::Status& status) { return std::string(status.message()); }

// Runs a line of shell in a temporary folder.
absl::StatusOr<std::string> Shell(const std::string& line) {
  const auto folder = TempFolder::Make();
  EXPECT_TRUE(folder.ok()) << folder.status();
  return RunProgramToSuccess({"sh", "-c", line}, folder->path());
}

TEST(TempFolder, IsRemovedWithWhatIsInIt) {
  std::string path;
  {
    auto made = TempFolder::Make();
    ASSERT_TRUE(made.ok()) << made.status();
    const TempFolder folder = *std::move(made);
    path = folder.path();
    std::ofstream(folder.File("a")) << "a";
    EXPECT_TRUE(std::filesystem::exists(path + "/a"));
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(RunProgram, ReturnsBothOutputs) {
  const auto text = Shell("echo out; echo err >&2; echo more");
  ASSERT_TRUE(text.ok()) << text.status();
  EXPECT_EQ(*text, "out\nerr\nmore\n");
}

TEST(RunProgram, RunsInTheFolder) {
  const auto folder = TempFolder::Make();
  ASSERT_TRUE(folder.ok());
  ASSERT_TRUE(RunProgramToSuccess({"sh", "-c", "echo x > made"}, folder->path()).ok());
  EXPECT_TRUE(std::filesystem::exists(folder->File("made")));
}

TEST(RunProgram, FailureEndsWithTheLastLines) {
  const auto text =
      Shell("for i in 1 2 3 4 5 6; do echo line $i >&2; done; printf '\\r\\n'; exit 3");
  ASSERT_FALSE(text.ok());
  EXPECT_THAT(MessageOf(text.status()), StartsWith("sh ended with status 3: line 3\n"));
  EXPECT_THAT(MessageOf(text.status()), EndsWith("line 5\nline 6"));
  EXPECT_THAT(MessageOf(text.status()), testing::Not(HasSubstr("line 2")));
}

TEST(RunProgram, SaysWhenThereWasNoWord) {
  EXPECT_THAT(MessageOf(Shell("exit 1").status()), EndsWith("status 1, without a word"));
}

TEST(RunProgram, SaysWhichSignalEndedIt) {
  EXPECT_THAT(MessageOf(Shell("kill -9 $$").status()), HasSubstr("ended by signal 9"));
}

TEST(RunProgram, OtherStatusesAreForTheCaller) {
  const auto folder = TempFolder::Make();
  ASSERT_TRUE(folder.ok());
  const auto output = RunProgram({"sh", "-c", "echo 1.0; exit 255"}, folder->path());
  ASSERT_TRUE(output.ok()) << output.status();
  EXPECT_EQ(output->exit_status, 255);
  EXPECT_EQ(output->text, "1.0\n");
}

TEST(RunProgram, SaysWhatIsNotThere) {
  const auto folder = TempFolder::Make();
  ASSERT_TRUE(folder.ok());
  EXPECT_THAT(MessageOf(RunProgram({"no-such-program"}, folder->path()).status()),
              StartsWith("no-such-program could not be started: "));
  EXPECT_FALSE(IsInstalled("no-such-program"));
  EXPECT_TRUE(IsInstalled("sh"));
}

}  // namespace
}  // namespace linetree
