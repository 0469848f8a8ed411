#include "peers/program_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace linetree {
namespace {

using testing::HasSubstr;

TEST(SecondsInLog, ReadsWhatTheProgramsWrite) {
  const std::string pov =
      "Render Time:\n  Photon Time:      No photons\n"
      "  Trace Time:       0 hours  1 minutes  2 seconds (62.125 seconds)\n"
      "              using 1 thread(s) with 60.1 CPU-seconds total\n";
  EXPECT_EQ(*SecondsInLog(pov, "Trace Time:"), 62.125);
  const std::string tachyon =
      "Preprocessing Time:     0.5000 seconds\nRendering Progress:       100% complete            "
      "\r"
      "  Ray Tracing Time:     0.0321 seconds\n    Image I/O Time:     0.0001 seconds\n";
  EXPECT_EQ(*SecondsInLog(tachyon, "Ray Tracing Time:"), 0.0321);
}

TEST(SecondsInLog, SaysWhatIsMissing) {
  EXPECT_THAT(SecondsInLog("nothing", "Trace Time:").status().message(),
              HasSubstr("'Trace Time: ... seconds'"));
  EXPECT_FALSE(SecondsInLog("Trace Time: long", "Trace Time:").ok());
  EXPECT_FALSE(SecondsInLog("Trace Time: some seconds", "Trace Time:").ok());
}

// A program that writes a picture of 1 x 1 pixel, as a line of shell.
ProgramRun ShellRun(const std::string& line) {
  return {{"sh", "-c", line}, "scene.txt", "the scene\n", "Time:"};
}
constexpr char kPicture[] = "printf 'P6 1 1 65535 \\377\\377\\0\\0\\200\\0' > picture.ppm; ";

TEST(PictureOfProgram, ReadsTimeAndPicture) {
  const auto picture =
      PictureOfProgram(ShellRun(std::string(kPicture) +
                                "grep -q 'the scene' scene.txt && echo 'Time: 0.25 seconds'"),
                       1, 1);
  ASSERT_TRUE(picture.ok()) << picture.status();
  EXPECT_EQ(picture->seconds, 0.25);
  ASSERT_EQ(picture->radiance.size(), 3u);
  EXPECT_EQ(picture->radiance[0], 1);
  EXPECT_EQ(picture->radiance[1], 0);
  EXPECT_FLOAT_EQ(picture->radiance[2], 32768 / 65535.0F);
}

TEST(PictureOfProgram, SaysWhatIsWrong) {
  const std::string ok = "echo 'Time: 0.25 seconds'";
  EXPECT_THAT(PictureOfProgram(ShellRun("echo broken; exit 2"), 1, 1).status().message(),
              HasSubstr("sh ended with status 2: broken"));
  EXPECT_THAT(PictureOfProgram(ShellRun(kPicture), 1, 1).status().message(), HasSubstr("'Time: "));
  EXPECT_THAT(PictureOfProgram(ShellRun(ok), 1, 1).status().message(), HasSubstr("picture.ppm"));
  EXPECT_THAT(PictureOfProgram(ShellRun(kPicture + ok), 2, 1).status().message(),
              HasSubstr("expected 2 x 1 pixels, found 1 x 1"));
  EXPECT_THAT(PictureOfProgram(ShellRun("echo no > picture.ppm; " + ok), 1, 1).status().message(),
              HasSubstr("expected a binary PPM"));
}

}  // namespace
}  // namespace linetree
