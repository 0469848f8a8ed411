#include "client/command/load_report.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/math/check.h"

namespace linetree {
namespace {

double LatencyMs(const LoadSample& sample) { return 1000 * (sample.end_s - sample.intended_s); }
double WaitMs(const LoadSample& sample) { return 1000 * (sample.start_s - sample.intended_s); }
double QueueMs(const LoadSample& sample) { return sample.timing.queue_ms; }
double RenderMs(const LoadSample& sample) { return sample.timing.render_ms; }
double EncodeMs(const LoadSample& sample) { return sample.timing.encode_ms; }

void Add(const FrameStats& stats, SourceCounts& sources) {
  sources.interpolated += stats.interpolated;
  sources.replayed += stats.replayed;
  sources.residual += stats.residual;
  sources.traced += stats.traced - stats.replayed - stats.residual;
}

std::vector<LoadBucket> Buckets(const std::vector<LoadSample>& samples, double seconds) {
  std::vector<LoadBucket> buckets(kLoadBuckets);
  const double length = seconds / kLoadBuckets;
  for (size_t i = 0; i < kLoadBuckets; ++i) {
    buckets[i].from_s = static_cast<double>(i) * length;
    buckets[i].to_s = static_cast<double>(i + 1) * length;
  }
  for (const LoadSample& sample : samples) {
    if (sample.refused) continue;
    const double place = length > 0 ? sample.end_s / length : 0;
    LoadBucket& bucket = buckets[std::min(static_cast<size_t>(place), size_t{kLoadBuckets - 1})];
    ++bucket.frames;
    Add(sample.stats, bucket.sources);
  }
  return buckets;
}

// A part of the time of every frame that was answered.
std::vector<double> PartsMs(const LoadPhase& phase, double (*part_ms)(const LoadSample&)) {
  std::vector<double> values;
  for (const LoadSample& sample : phase.samples) {
    if (!sample.refused) values.push_back(part_ms(sample));
  }
  return values;
}

nlohmann::json Json(const Quantiles& q) {
  return {{"p50", q.p50}, {"p90", q.p90}, {"p99", q.p99}, {"max", q.max}};
}

nlohmann::json Json(const SourceCounts& sources) {
  return {{"interpolated", sources.Share(sources.interpolated)},
          {"replayed", sources.Share(sources.replayed)},
          {"residual", sources.Share(sources.residual)},
          {"traced", sources.Share(sources.traced)}};
}

double Middle(const LoadBucket& bucket) { return (bucket.from_s + bucket.to_s) / 2; }

// Values over their percentiles.
PlotSeries RankSeries(const std::string& name, const std::vector<double>& values) {
  PlotSeries series{name, {}};
  for (const double percent :
       {1., 5., 10., 20., 30., 40., 50., 60., 70., 80., 90., 95., 99., 100.}) {
    series.points.emplace_back(percent, NearestRank(values, percent / 100));
  }
  return series;
}

}  // namespace

double SourceCounts::Share(uint64_t part) const {
  const uint64_t all = Sum();
  return all == 0 ? 0 : static_cast<double>(part) / static_cast<double>(all);
}

double NearestRank(std::vector<double> values, double share) {
  LT_CHECK(share > 0 && share <= 1);
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<size_t>(std::ceil(share * static_cast<double>(values.size())));
  return values[std::clamp(rank, size_t{1}, values.size()) - 1];
}

Quantiles QuantilesOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {.p50 = NearestRank(values, 0.5),
          .p90 = NearestRank(values, 0.9),
          .p99 = NearestRank(values, 0.99),
          .max = NearestRank(values, 1)};
}

double NetworkMs(const LoadSample& sample) {
  const FrameTiming& t = sample.timing;
  const double server_ms = t.queue_ms + t.render_ms + t.encode_ms;
  return std::max(0.0, 1000 * (sample.end_s - sample.start_s) - server_ms);
}

LoadFigures SummarizeLoad(const LoadPhase& phase) {
  LoadFigures figures{.phase = phase.name,
                      .not_begun = phase.not_begun,
                      .overtaken = phase.overtaken,
                      .cells_built = phase.cells_built,
                      .cells_evicted = phase.cells_evicted};
  double last_s = 0;
  for (const LoadSample& sample : phase.samples) {
    figures.seconds = std::max(figures.seconds, sample.end_s);
    figures.late += sample.late;
    figures.refused += sample.refused;
    if (sample.refused) continue;
    ++figures.frames;
    Add(sample.stats, figures.sources);
    figures.wire_bytes += sample.wire_bytes;
    if (sample.end_s >= last_s) figures.cache_bytes = sample.stats.cache_bytes;
    last_s = std::max(last_s, sample.end_s);
  }
  if (figures.seconds > 0) {
    figures.frames_per_s = static_cast<double>(figures.frames) / figures.seconds;
  }
  figures.latency = QuantilesOf(PartsMs(phase, LatencyMs));
  figures.wait = QuantilesOf(PartsMs(phase, WaitMs));
  figures.queue = QuantilesOf(PartsMs(phase, QueueMs));
  figures.render = QuantilesOf(PartsMs(phase, RenderMs));
  figures.encode = QuantilesOf(PartsMs(phase, EncodeMs));
  figures.network = QuantilesOf(PartsMs(phase, NetworkMs));
  figures.light = QuantilesOf(phase.light_calls_ms);
  figures.light_calls = phase.light_calls_ms.size();
  if (!phase.samples.empty()) figures.buckets = Buckets(phase.samples, figures.seconds);
  return figures;
}

nlohmann::json LoadJson(const LoadFigures& figures) {
  nlohmann::json over_time = nlohmann::json::array();
  for (const LoadBucket& bucket : figures.buckets) {
    over_time.push_back({{"from_s", bucket.from_s},
                         {"to_s", bucket.to_s},
                         {"frames", bucket.frames},
                         {"hit_rate", bucket.sources.HitRate()},
                         {"sources", Json(bucket.sources)}});
  }
  return {{"frames", figures.frames},
          {"refused", figures.refused},
          {"late", figures.late},
          {"not_begun", figures.not_begun},
          {"overtaken", figures.overtaken},
          {"seconds", figures.seconds},
          {"frames_per_s", figures.frames_per_s},
          {"latency_ms", Json(figures.latency)},
          {"wait_ms", Json(figures.wait)},
          {"queue_ms", Json(figures.queue)},
          {"render_ms", Json(figures.render)},
          {"encode_ms", Json(figures.encode)},
          {"network_ms", Json(figures.network)},
          {"light_ms", Json(figures.light)},
          {"light_calls", figures.light_calls},
          {"hit_rate", figures.sources.HitRate()},
          {"sources", Json(figures.sources)},
          {"wire_bytes", figures.wire_bytes},
          {"cells_built", figures.cells_built},
          {"cells_evicted", figures.cells_evicted},
          {"cache_bytes", figures.cache_bytes},
          {"over_time", std::move(over_time)}};
}

std::string LoadCsv(const std::vector<LoadPhase>& phases) {
  std::string csv =
      "phase,client,frame,intended_s,start_s,end_s,late,refused,queue_ms,render_ms,encode_ms,"
      "network_ms,wire_bytes,interpolated,replayed,residual,traced,background,cells_accepted,"
      "cells_evicted,cache_bytes\n";
  for (const LoadPhase& phase : phases) {
    for (const LoadSample& s : phase.samples) {
      SourceCounts sources;
      Add(s.stats, sources);
      absl::StrAppendFormat(&csv, "%s,%d,%d,%.6f,%.6f,%.6f,%d,%d,%.3f,%.3f,%.3f,%.3f,%d",
                            phase.name, s.client, s.frame, s.intended_s, s.start_s, s.end_s, s.late,
                            s.refused, s.timing.queue_ms, s.timing.render_ms, s.timing.encode_ms,
                            s.refused ? 0 : NetworkMs(s), s.wire_bytes);
      absl::StrAppendFormat(&csv, ",%d,%d,%d,%d,%d,%d,%d,%d\n", sources.interpolated,
                            sources.replayed, sources.residual, sources.traced, s.stats.background,
                            s.stats.cells_accepted, s.stats.cells_evicted, s.stats.cache_bytes);
    }
  }
  return csv;
}

std::vector<Plot> LoadPlots(const LoadPhase& phase, const LoadFigures& figures,
                            const std::string& title) {
  PlotSeries hits{"hits", {}}, interpolated{"interpolated", {}}, replayed{"replayed", {}};
  PlotSeries residual{"residual", {}}, traced{"traced", {}}, rate{"frames/s", {}};
  for (const LoadBucket& bucket : figures.buckets) {
    const double at_s = Middle(bucket);
    rate.points.emplace_back(at_s,
                             static_cast<double>(bucket.frames) / (bucket.to_s - bucket.from_s));
    // A bucket in which no frame ended says nothing of the cache.
    if (bucket.frames == 0) continue;
    const SourceCounts& of = bucket.sources;
    hits.points.emplace_back(at_s, 100 * of.HitRate());
    interpolated.points.emplace_back(at_s, 100 * of.Share(of.interpolated));
    replayed.points.emplace_back(at_s, 100 * of.Share(of.replayed));
    residual.points.emplace_back(at_s, 100 * of.Share(of.residual));
    traced.points.emplace_back(at_s, 100 * of.Share(of.traced));
  }
  const PlotAxis time{.label = "seconds", .min = 0, .max = figures.seconds};
  const PlotAxis percent{.label = "pixels that hit something, %", .min = 0, .max = 100};
  return {
      {title + ": answers by source",
       time,
       percent,
       {std::move(hits), std::move(interpolated), std::move(replayed), std::move(residual),
        std::move(traced)}},
      {title + ": throughput", time, {.label = "frames per second"}, {std::move(rate)}},
      {title + ": latencies by rank",
       {.label = "percentile", .min = 0, .max = 100},
       {.label = "ms", .logarithmic = true},
       {RankSeries("latency", PartsMs(phase, LatencyMs)),
        RankSeries("wait", PartsMs(phase, WaitMs)), RankSeries("queue", PartsMs(phase, QueueMs)),
        RankSeries("render", PartsMs(phase, RenderMs)),
        RankSeries("encode", PartsMs(phase, EncodeMs)),
        RankSeries("network", PartsMs(phase, NetworkMs))}}};
}

}  // namespace linetree
