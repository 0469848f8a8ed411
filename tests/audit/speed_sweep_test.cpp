#include "core/audit/speed_sweep.h"

#include <gtest/gtest.h>

namespace linetree {
namespace {

SpeedSource MadeSource() {
  const MadeScene made = {"room", 18, 2};
  return {made.Text(), Make(made), made};
}
SpeedSource FileSource() { return {"file", MakeRoom(18, 2, false), std::nullopt}; }

SpeedSetting At(Sweep sweep, double point, const SpeedSource& source = MadeSource()) {
  return *SettingAt(sweep, point, source, SpeedSetting{});
}

TEST(SpeedSweepTest, EachVariesItsOwnNumber) {
  EXPECT_EQ(At(Sweep::kLights, 7).scene->lights.size(), 7u);
  EXPECT_EQ(At(Sweep::kLights, 7, FileSource()).scene->lights.size(), 7u);
  EXPECT_EQ(At(Sweep::kObjects, 60).scene->objects.size(), 60u);
  EXPECT_EQ(At(Sweep::kLights, 7).name, "room:18:N");
  EXPECT_EQ(At(Sweep::kObjects, 60).name, "room:N:2");
  EXPECT_EQ(At(Sweep::kDepth, 8).options.limits.max_depth, 8);
  EXPECT_EQ(At(Sweep::kResolution, 300).options.width, 300);
  EXPECT_EQ(At(Sweep::kResolution, 300).options.height, 300);
  EXPECT_EQ(At(Sweep::kEpsilon, 0.125).options.epsilon, 0.125);
  EXPECT_EQ(At(Sweep::kThreads, 3).threads, 3);
  EXPECT_EQ(At(Sweep::kSamples, 9).options.sampling.samples, 9);
}

TEST(SpeedSweepTest, TheRestIsLeftAsItIs) {
  SpeedSetting base;
  base.options.epsilon = 0.25;
  base.options.limits.max_depth = 7;
  base.threads = 2;
  const SpeedSource source = MadeSource();
  const SpeedSetting setting = *SettingAt(Sweep::kResolution, 64, source, base);
  EXPECT_EQ(setting.name, "room:18:2");
  EXPECT_EQ(setting.scene, source.scene);
  EXPECT_EQ(setting.options.epsilon, 0.25);
  EXPECT_EQ(setting.options.limits.max_depth, 7);
  EXPECT_EQ(setting.threads, 2);
}

TEST(SpeedSweepTest, ObjectsAreThoseOfMadeScenes) {
  const auto setting = SettingAt(Sweep::kObjects, 60, FileSource(), {});
  EXPECT_TRUE(absl::IsInvalidArgument(setting.status()));
}

TEST(SpeedSweepTest, ItsOwnPointsAndScenesAreGood) {
  for (size_t i = 0; i < kSweepNames.size(); ++i) {
    const auto sweep = static_cast<Sweep>(i);
    const std::vector<double> points = DefaultPoints(sweep);
    EXPECT_GE(points.size(), 2u) << NameOf(sweep);
    for (const double point : points) EXPECT_EQ(ValidatePoint(sweep, point), absl::OkStatus());
    EXPECT_FALSE(DefaultMadeScenes(sweep).empty()) << NameOf(sweep);
    for (const std::string& text : DefaultMadeScenes(sweep)) {
      EXPECT_EQ(ParseMadeScene(text).status(), absl::OkStatus());
    }
  }
}

TEST(SpeedSweepTest, PointsAreChecked) {
  EXPECT_FALSE(ValidatePoint(Sweep::kLights, 0).ok());
  EXPECT_FALSE(ValidatePoint(Sweep::kLights, 1.5).ok());
  EXPECT_FALSE(ValidatePoint(Sweep::kDepth, kMaxPathDepth + 1).ok());
  EXPECT_FALSE(ValidatePoint(Sweep::kEpsilon, -0.1).ok());
  EXPECT_TRUE(ValidatePoint(Sweep::kEpsilon, 0.1).ok());
  EXPECT_FALSE(ValidatePoint(Sweep::kSamples, kMaxPixelSamples + 1).ok());
}

}  // namespace
}  // namespace linetree
