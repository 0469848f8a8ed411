#include "client/command/frame_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/io/frames.h"

namespace linetree {
namespace {

using ::testing::HasSubstr;

Frame CountedFrame(uint64_t interpolated, uint64_t traced) {
  Frame frame = MakeFrame(4, 2);
  frame.stats.interpolated = interpolated;
  frame.stats.traced = traced;
  frame.stats.base.intersect = 1000;
  frame.stats.ip.intersect = 234;
  return frame;
}

TEST(FrameReport, ALineForEveryFrame) {
  std::ostringstream out;
  FrameReport report("room", {}, &out);
  report.Add(CountedFrame(3, 1));
  report.Add(CountedFrame(4, 0));
  EXPECT_THAT(out.str(), HasSubstr("hit rate"));
  EXPECT_THAT(out.str(), HasSubstr("75.0 %"));
  EXPECT_THAT(out.str(), HasSubstr("100.0 %"));
  EXPECT_THAT(out.str(), HasSubstr("1,234"));
}

TEST(FrameReport, JsonOfOneFrameHasItsCountersOnTop) {
  RenderOptions options;
  options.max_relative_error = 0.25;
  FrameReport report("room", options, nullptr);
  report.Add(CountedFrame(3, 1));
  const nlohmann::json json = report.ToJson();
  EXPECT_EQ(json["scene"], "room");
  EXPECT_EQ(json["scene_version"], "0123456789abcdef0123456789abcdef");
  EXPECT_EQ(json["mode"], "cached");
  EXPECT_EQ(json["epsilon"], 0.25);
  EXPECT_EQ(json["interpolated"], 3);
  EXPECT_EQ(json["width"], 4);
  EXPECT_EQ(json["frames"].size(), 1u);
}

TEST(FrameReport, JsonOfSeveralFramesListsThem) {
  RenderOptions options;
  options.mode = Mode::kClassical;
  FrameReport report("room", options, nullptr);
  report.Add(CountedFrame(3, 1));
  report.Add(CountedFrame(2, 2));
  const nlohmann::json json = report.ToJson();
  EXPECT_EQ(json["mode"], "classical");
  EXPECT_FALSE(json.contains("interpolated"));
  ASSERT_EQ(json["frames"].size(), 2u);
  EXPECT_EQ(json["frames"][0]["interpolated"], 3);
  EXPECT_EQ(json["frames"][1]["interpolated"], 2);
}

}  // namespace
}  // namespace linetree
