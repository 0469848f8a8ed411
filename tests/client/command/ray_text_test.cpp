#include "client/command/ray_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <sstream>

namespace linetree {
namespace {

using ::testing::StartsWith;

std::string ErrorOf(const std::string& text) {
  std::istringstream in(text);
  return std::string(RayReader(in, "r.txt").Next(100).status().message());
}

TEST(RayText, ReadsRaysBlockByBlock) {
  std::istringstream in("# a comment\n0 1 2 3 4 5\n\n  \t\n -1e2\t.5 +3 0 0 -1 \r\n1 1 1 1 1 1");
  RayReader reader(in, "r.txt");
  const auto first = reader.Next(2);
  ASSERT_EQ(first.status(), absl::OkStatus());
  ASSERT_EQ(first->size(), 2u);
  EXPECT_EQ((*first)[0].origin, (Vec3d{0, 1, 2}));
  EXPECT_EQ((*first)[0].direction, (Vec3d{3, 4, 5}));
  EXPECT_EQ((*first)[1].origin, (Vec3d{-100, 0.5, 3}));
  EXPECT_EQ(reader.Next(2)->size(), 1u);
  EXPECT_EQ(reader.Next(2)->size(), 0u);
}

TEST(RayText, ErrorsCountLines) {
  const std::string good = "0 0 0 0 0 1\n# comment\n";
  for (const char* bad : {"0 0 0 0 0", "0 0 0 0 0 1 2", "0 0 0 0 0 x", "0 0 0 0 0 0",
                          "0 0 0 0 0 nan", "inf 0 0 0 0 1", "0,0,0,0,0,1"}) {
    EXPECT_THAT(ErrorOf(good + bad), StartsWith("r.txt:3: expected six finite numbers")) << bad;
  }
}

TEST(RayText, LinesReadBackToTheSameFloat) {
  RayAnswer answer;
  answer.radiance = {0.1, 1.0 / 3, 12345.678};
  answer.source = Source::kInterpolated;
  answer.object = 4;
  answer.depth = 2.5;
  const std::string line = RayAnswerLine(answer);
  std::istringstream in(line);
  float r = 0, g = 0, b = 0;
  std::string source;
  int object = 0;
  double depth = 0;
  in >> r >> g >> b >> source >> object >> depth;
  EXPECT_EQ(r, 0.1f);
  EXPECT_EQ(g, static_cast<float>(1.0 / 3));
  EXPECT_EQ(b, 12345.678f);
  EXPECT_EQ(source, "interpolated");
  EXPECT_EQ(object, 4);
  EXPECT_EQ(depth, 2.5);
}

TEST(RayText, TheBackgroundHasNoObjectAndNoDepth) {
  RayAnswer answer;
  answer.depth = std::numeric_limits<double>::infinity();
  EXPECT_EQ(RayAnswerLine(answer), "0 0 0 background -1 inf\n");
  EXPECT_TRUE(RayAnswerJson(answer)["depth"].is_null());
  EXPECT_EQ(RayAnswerJson(answer)["object"], -1);
}

}  // namespace
}  // namespace linetree
