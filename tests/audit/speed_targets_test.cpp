#include "core/audit/speed_targets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/audit/speed_scenes.h"

namespace linetree {
namespace {

using What = SpeedTarget::What;

// A row of the table that was set.
TEST(SpeedTargetsTest, RowsAreThoseOfTheTable) {
  const std::vector<SpeedTarget> targets = SpeedTargets();
  const auto goal = [&](const std::string& scene, int width, SpeedPath path, double epsilon) {
    for (const SpeedTarget& t : targets) {
      if (t.scene == scene && t.width == width && t.path == path && t.epsilon == epsilon &&
          t.what == What::kMedian) {
        return t.goal;
      }
    }
    return 0.0;
  };
  EXPECT_EQ(goal("room:18:16", 512, SpeedPath::kWarm, 0.02), 6);
  EXPECT_EQ(goal("room:18:16", 1920, SpeedPath::kWarm, 0.02), 11);
  EXPECT_EQ(goal("room:18:16", 1920, SpeedPath::kCold, 0.02), 7);
  EXPECT_EQ(goal("room:18:16", 512, SpeedPath::kWarm, 0), 5);
  EXPECT_EQ(goal("mirrors:18:16", 1920, SpeedPath::kCold, 0.02), 6);
  EXPECT_EQ(goal("glass:18:3", 1920, SpeedPath::kCold, 0.02), 0);  // no goal
}

// A run is measured once.
TEST(SpeedTargetsTest, RowsOfOneRunAreNeighbours) {
  const std::vector<SpeedTarget> targets = SpeedTargets();
  size_t runs = 0;
  for (size_t i = 0; i < targets.size(); ++i) {
    runs += i == 0 || !targets[i].SharesRunWith(targets[i - 1]) ? 1 : 0;
  }
  EXPECT_LT(runs, targets.size());
  EXPECT_TRUE(targets[1].SharesRunWith(targets[2]));  // warm and cold at 1920 x 1080
  EXPECT_FALSE(targets[0].SharesRunWith(targets[1]));
}

SpeedTarget SmallTarget(SpeedPath path, What what) {
  return {.scene = "room:18:2", .width = 24, .height = 24, .path = path, .what = what};
}

std::vector<TargetResult> Measured(const std::vector<SpeedTarget>& targets) {
  SpeedFlights flights;
  flights.still_frames = 2;
  flights.flight_frames = 3;
  auto results =
      MeasureTargets(targets, Make(*ParseMadeScene(targets[0].scene)), 1, flights, nullptr);
  EXPECT_TRUE(results.ok()) << results.status();
  return *std::move(results);
}

TEST(SpeedTargetsTest, EveryKindIsMeasured) {
  const std::vector<SpeedTarget> targets = {SmallTarget(SpeedPath::kWarm, What::kMedian),
                                            SmallTarget(SpeedPath::kWarm, What::kThreads),
                                            SmallTarget(SpeedPath::kTeleport, What::kLeast),
                                            SmallTarget(SpeedPath::kTeleport, What::kMedian)};
  const std::vector<TargetResult> results = Measured(targets);
  ASSERT_EQ(results.size(), 4u);
  for (const TargetResult& result : results) {
    EXPECT_GT(result.measured, 0);
    EXPECT_EQ(result.beyond, 0u);
    ASSERT_TRUE(result.roofline.has_value());
    EXPECT_GT(result.roofline->classical, 0);
  }
  EXPECT_LE(results[2].measured, results[3].measured);
}

TEST(SpeedTargetsTest, AGoalIsMetFromItselfOn) {
  TargetResult result;
  result.target.goal = 2;
  EXPECT_FALSE(result.IsMet());
  result.measured = 1.99;
  EXPECT_FALSE(result.IsMet());
  result.measured = 2;
  EXPECT_TRUE(result.IsMet());
}

TEST(SpeedTargetsTest, FramesOfSeveralSamplesAreMeasuredOnTheirOwn) {
  const std::vector<SpeedTarget> targets = SpeedTargets();
  const auto sampled = std::find_if(targets.begin(), targets.end(),
                                    [](const SpeedTarget& t) { return t.samples > 1; });
  ASSERT_NE(sampled, targets.end());
  EXPECT_EQ(sampled->samples, 16);
  EXPECT_EQ(sampled->goal, 8);
  SpeedTarget plain = *sampled;
  plain.samples = 1;
  EXPECT_FALSE(sampled->SharesRunWith(plain));
  SpeedTarget small = SmallTarget(SpeedPath::kWarm, What::kMedian);
  small.samples = 4;
  const std::vector<TargetResult> results = Measured({small});
  ASSERT_EQ(results.size(), 1u);
  EXPECT_GT(results[0].measured, 0);
  EXPECT_EQ(results[0].beyond, 0u);
  EXPECT_FALSE(results[0].roofline.has_value()) << "its pixels may do without their rays";
}

}  // namespace
}  // namespace linetree
