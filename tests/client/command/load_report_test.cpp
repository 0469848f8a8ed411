#include "client/command/load_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_split.h"

namespace linetree {
namespace {

LoadSample SampleOf(double start_s, double end_s, uint64_t hits, uint64_t traced) {
  LoadSample sample{.intended_s = start_s, .start_s = start_s, .end_s = end_s};
  sample.stats.interpolated = hits;
  sample.stats.traced = traced;
  return sample;
}

LoadFigures FiguresOf(std::vector<LoadSample> samples) {
  return SummarizeLoad({.name = "measured", .samples = std::move(samples)});
}

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
    samples.push_back(SampleOf(end - 0.01 * (i + 1), end, i < 5 ? 0u : 30u, i < 5 ? 10u : 0u));
  }
  const LoadFigures figures = FiguresOf(samples);
  EXPECT_EQ(figures.frames, 10u);
  EXPECT_DOUBLE_EQ(figures.seconds, 2);
  EXPECT_DOUBLE_EQ(figures.frames_per_s, 5);
  EXPECT_NEAR(figures.latency.p50, 50, 1e-9);
  EXPECT_NEAR(figures.latency.p90, 90, 1e-9);
  EXPECT_NEAR(figures.latency.p99, 100, 1e-9);
  EXPECT_NEAR(figures.latency.max, 100, 1e-9);
  EXPECT_DOUBLE_EQ(figures.sources.HitRate(), 150.0 / 200);
  ASSERT_EQ(figures.buckets.size(), size_t{kLoadBuckets});
  EXPECT_EQ(figures.buckets.front().sources.HitRate(), 0);
  EXPECT_EQ(figures.buckets.back().sources.HitRate(), 1);
  uint64_t frames = 0;
  for (const LoadBucket& bucket : figures.buckets) frames += bucket.frames;
  EXPECT_EQ(frames, 10u);
}

TEST(LoadReport, LatencyCountsFromWhenAFrameWasToBegin) {
  LoadSample late = SampleOf(3, 3.5, 1, 0);
  late.intended_s = 1;
  late.late = true;
  late.timing = {.queue_ms = 100, .render_ms = 200, .encode_ms = 50};
  const LoadFigures figures = FiguresOf({late});
  EXPECT_EQ(figures.late, 1u);
  EXPECT_EQ(figures.latency.p50, 2500);
  EXPECT_EQ(figures.wait.p50, 2000);
  EXPECT_EQ(figures.queue.p50, 100);
  EXPECT_EQ(figures.render.p50, 200);
  EXPECT_EQ(figures.encode.p50, 50);
  EXPECT_NEAR(figures.network.p50, 150, 1e-9);
}

TEST(LoadReport, RefusedFramesCountAsNothingElse) {
  LoadSample refused = SampleOf(0, 9, 0, 0);
  refused.refused = true;
  const LoadFigures figures = FiguresOf({refused, SampleOf(0, 0.5, 3, 1)});
  EXPECT_EQ(figures.refused, 1u);
  EXPECT_EQ(figures.frames, 1u);
  EXPECT_EQ(figures.latency.max, 500);
  EXPECT_EQ(figures.seconds, 9);
}

TEST(LoadReport, SourcesAddUpToWhatWasHit) {
  LoadSample sample = SampleOf(0, 1, 10, 90);
  sample.stats.replayed = 20;
  sample.stats.residual = 30;
  sample.stats.background = 1000;
  const SourceCounts sources = FiguresOf({sample}).sources;
  EXPECT_EQ(sources.Sum(), 100u);
  EXPECT_EQ(sources.traced, 40u);
  EXPECT_DOUBLE_EQ(sources.HitRate(), 0.3);
  EXPECT_DOUBLE_EQ(sources.Share(sources.residual), 0.3);
}

TEST(LoadReport, NothingHappenedIsAllZero) {
  const LoadFigures figures = FiguresOf({});
  EXPECT_EQ(figures.frames, 0u);
  EXPECT_EQ(figures.frames_per_s, 0);
  EXPECT_EQ(LoadJson(figures)["latency_ms"]["p99"], 0.0);
}

TEST(LoadReport, JsonHoldsTheFigures) {
  const nlohmann::json json = LoadJson(FiguresOf({SampleOf(0, 0.5, 3, 1)}));
  EXPECT_EQ(json["frames"], 1);
  EXPECT_EQ(json["latency_ms"]["p50"], 500.0);
  EXPECT_EQ(json["hit_rate"], 0.75);
  EXPECT_EQ(json["sources"]["interpolated"], 0.75);
  EXPECT_EQ(json["over_time"].size(), size_t{kLoadBuckets});
}

TEST(LoadReport, CsvHasALineForEachFrameOfAllPhases) {
  const LoadPhase phase{.name = "p", .samples = {SampleOf(0, 1, 3, 1), SampleOf(1, 2, 3, 1)}};
  const std::vector<std::string> lines = absl::StrSplit(LoadCsv({phase, phase}), '\n');
  ASSERT_EQ(lines.size(), 6u);  // titles, four frames, and nothing
  const size_t columns = std::vector<std::string>(absl::StrSplit(lines[0], ',')).size();
  for (size_t i = 1; i <= 4; ++i) {
    EXPECT_EQ(std::vector<std::string>(absl::StrSplit(lines[i], ',')).size(), columns);
  }
}

TEST(LoadReport, BucketsWithoutFramesHaveNoHitRateToPlot) {
  const LoadPhase phase{.samples = {SampleOf(0, 0.5, 3, 1), SampleOf(0.5, 4, 1, 1)}};
  const std::vector<Plot> plots = LoadPlots(phase, SummarizeLoad(phase), "t");
  ASSERT_EQ(plots.size(), 3u);
  EXPECT_EQ(plots[0].series[0].points.size(), 2u);
  EXPECT_EQ(plots[1].series[0].points.size(), size_t{kLoadBuckets});
}

}  // namespace
}  // namespace linetree
