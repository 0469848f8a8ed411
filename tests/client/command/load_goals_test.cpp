#include "client/command/load_goals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/command/load_page.h"

namespace linetree {
namespace {

using ::testing::HasSubstr;

// Ten frames at 20 ms, of which three quarters of the pixels hit.
LoadFigures SomeFigures() {
  LoadFigures figures{.frames = 10, .frames_per_s = 5};
  figures.latency = {.p50 = 20, .p90 = 20, .p99 = 20, .max = 20};
  figures.sources = {.interpolated = 3, .traced = 1};
  return figures;
}

bool Meets(const std::string& objective) {
  const auto parsed = ParseObjective(objective);
  EXPECT_TRUE(parsed.ok()) << parsed.status();
  return IsMet(*parsed, SomeFigures());
}

TEST(LoadGoals, LatencyIsToStayBelowAndHitRateAbove) {
  EXPECT_TRUE(Meets("p99_ms=20"));
  EXPECT_FALSE(Meets("p99_ms=19.9"));
  EXPECT_TRUE(Meets("hit_rate=0.75"));
  EXPECT_FALSE(Meets("hit_rate=0.76"));
  EXPECT_TRUE(Meets("refused=0"));
}

TEST(LoadGoals, WithoutAFrameNothingIsMet) {
  EXPECT_FALSE(IsMet(*ParseObjective("p99_ms=20"), LoadFigures()));
}

TEST(LoadGoals, AWrongObjectiveSaysWhatIsRight) {
  EXPECT_THAT(ParseObjective("speed=3").status().message(), HasSubstr("expected one of"));
  for (const char* text : {"p99_ms", "p99_ms=", "p99_ms=fast", "p99_ms=nan", "=1", ""}) {
    EXPECT_FALSE(ParseObjective(text).ok()) << text;
  }
}

TEST(LoadGoals, OneMissedObjectiveIsEnough) {
  LoadResult result{.figures = {SomeFigures()}};
  EXPECT_TRUE(result.MeetsObjectives());
  result.objectives = {*ParseObjective("p50_ms=30"), *ParseObjective("hit_rate=0.9")};
  EXPECT_FALSE(result.MeetsObjectives());
  EXPECT_THAT(ObjectiveTable(result.objectives, result.measured()), HasSubstr("NO"));
}

TEST(LoadGoals, ComparisonKnowsWhatIsBetter) {
  LoadFigures now = SomeFigures();
  now.latency.p99 = 10;
  now.frames_per_s = 4;
  const auto changes = CompareLoads({{"metrics", MetricsJson(SomeFigures())}}, now);
  ASSERT_TRUE(changes.ok()) << changes.status();
  ASSERT_EQ(changes->size(), LoadMetrics().size());
  const nlohmann::json json = ChangesJson(*changes);
  EXPECT_EQ(json["p99_ms"]["is"], "better");
  EXPECT_EQ(json["p99_ms"]["difference"], -10.0);
  EXPECT_EQ(json["frames_per_s"]["is"], "worse");
  EXPECT_EQ(json["hit_rate"]["is"], "equal");
  EXPECT_THAT(ChangeTable(*changes), HasSubstr("-50.0"));
}

TEST(LoadGoals, OnlyWhatLoadWroteIsCompared) {
  const LoadFigures now = SomeFigures();
  for (const char* text : {"3", "{}", R"({"metrics": 1})", R"({"metrics": {"p99_ms": "x"}})"}) {
    EXPECT_FALSE(CompareLoads(nlohmann::json::parse(text), now).ok()) << text;
  }
  // A metric that an older version did not have is left out.
  EXPECT_EQ(CompareLoads(nlohmann::json::parse(R"({"metrics": {"p99_ms": 1}})"), now)->size(), 1u);
}

}  // namespace
}  // namespace linetree
