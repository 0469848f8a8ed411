#include "client/command/load_report.h"

#include <gtest/gtest.h>

namespace linetree {
namespace {

TEST(LoadReport, NearestRanks) {
  EXPECT_EQ(NearestRank({}, 0.5), 0);
  EXPECT_EQ(NearestRank({7}, 0.01), 7);
  EXPECT_EQ(NearestRank({4, 1, 3, 2}, 0.5), 2);
  EXPECT_EQ(NearestRank({4, 1, 3, 2}, 0.51), 3);
  EXPECT_EQ(NearestRank({4, 1, 3, 2}, 1), 4);
}

TEST(LoadReport, FiguresOfKnownSamples) {
  std::vector<LoadSample> samples;
  for (int i = 0; i < 10; ++i) {
    // Frame i takes (i + 1) * 10 ms and ends at second 2 (i + 1) / 10; the later half is all hits.
    const double end = 0.2 * (i + 1);
    samples.push_back({end - 0.01 * (i + 1), end, i < 5 ? 0u : 30u, i < 5 ? 10u : 0u});
  }
  const LoadFigures figures = SummarizeLoad(samples);
  EXPECT_EQ(figures.frames, 10u);
  EXPECT_DOUBLE_EQ(figures.seconds, 2);
  EXPECT_DOUBLE_EQ(figures.frames_per_s, 5);
  EXPECT_NEAR(figures.p50_ms, 50, 1e-9);
  EXPECT_NEAR(figures.p90_ms, 90, 1e-9);
  EXPECT_NEAR(figures.p99_ms, 100, 1e-9);
  EXPECT_NEAR(figures.max_ms, 100, 1e-9);
  EXPECT_DOUBLE_EQ(figures.hit_rate, 150.0 / 200);
  ASSERT_EQ(figures.buckets.size(), size_t{kLoadBuckets});
  EXPECT_EQ(figures.buckets.front().hit_rate, 0);
  EXPECT_EQ(figures.buckets.back().hit_rate, 1);
  uint64_t frames = 0;
  for (const LoadBucket& bucket : figures.buckets) frames += bucket.frames;
  EXPECT_EQ(frames, 10u);
}

TEST(LoadReport, NothingHappenedIsAllZero) {
  const LoadFigures figures = SummarizeLoad({});
  EXPECT_EQ(figures.frames, 0u);
  EXPECT_EQ(figures.frames_per_s, 0);
  EXPECT_EQ(LoadJson(figures)["latency_ms"]["p99"], 0.0);
}

TEST(LoadReport, JsonHoldsTheFigures) {
  const nlohmann::json json = LoadJson(SummarizeLoad({{0, 0.5, 3, 1}}));
  EXPECT_EQ(json["frames"], 1);
  EXPECT_EQ(json["latency_ms"]["p50"], 500.0);
  EXPECT_EQ(json["hit_rate"], 0.75);
  EXPECT_EQ(json["over_time"].size(), size_t{kLoadBuckets});
}

TEST(LoadReport, BucketsWithoutFramesHaveNoHitRateToPlot) {
  const std::vector<Plot> plots = LoadPlots(SummarizeLoad({{0, 0.5, 3, 1}, {0.5, 4, 1, 1}}), "t");
  ASSERT_EQ(plots.size(), 2u);
  EXPECT_EQ(plots[0].series[0].points.size(), 2u);
  EXPECT_EQ(plots[1].series[0].points.size(), size_t{kLoadBuckets});
}

}  // namespace
}  // namespace linetree
