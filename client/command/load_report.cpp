#include "client/command/load_report.h"

#include <algorithm>
#include <cmath>

#include "core/math/check.h"

namespace linetree {
namespace {

double Share(uint64_t hits, uint64_t misses) {
  const uint64_t all = hits + misses;
  return all == 0 ? 0 : static_cast<double>(hits) / static_cast<double>(all);
}

std::vector<LoadBucket> Buckets(const std::vector<LoadSample>& samples, double seconds) {
  std::vector<LoadBucket> buckets(kLoadBuckets);
  std::vector<uint64_t> hits(kLoadBuckets);
  std::vector<uint64_t> misses(kLoadBuckets);
  const double length = seconds / kLoadBuckets;
  for (size_t i = 0; i < kLoadBuckets; ++i) {
    buckets[i].from_s = static_cast<double>(i) * length;
    buckets[i].to_s = static_cast<double>(i + 1) * length;
  }
  for (const LoadSample& sample : samples) {
    const double place = length > 0 ? sample.end_s / length : 0;
    const size_t i = std::min(static_cast<size_t>(place), size_t{kLoadBuckets - 1});
    ++buckets[i].frames;
    hits[i] += sample.hits;
    misses[i] += sample.misses;
  }
  for (size_t i = 0; i < kLoadBuckets; ++i) {
    buckets[i].hit_rate = Share(hits[i], misses[i]);
  }
  return buckets;
}

}  // namespace

double NearestRank(std::vector<double> values, double share) {
  LT_CHECK(share > 0 && share <= 1);
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<size_t>(std::ceil(share * static_cast<double>(values.size())));
  return values[std::clamp(rank, size_t{1}, values.size()) - 1];
}

LoadFigures SummarizeLoad(const std::vector<LoadSample>& samples) {
  LoadFigures figures;
  if (samples.empty()) return figures;
  std::vector<double> latencies_ms;
  uint64_t hits = 0;
  uint64_t misses = 0;
  for (const LoadSample& sample : samples) {
    latencies_ms.push_back(1000 * (sample.end_s - sample.start_s));
    figures.seconds = std::max(figures.seconds, sample.end_s);
    hits += sample.hits;
    misses += sample.misses;
  }
  figures.frames = samples.size();
  if (figures.seconds > 0) {
    figures.frames_per_s = static_cast<double>(samples.size()) / figures.seconds;
  }
  figures.p50_ms = NearestRank(latencies_ms, 0.5);
  figures.p90_ms = NearestRank(latencies_ms, 0.9);
  figures.p99_ms = NearestRank(latencies_ms, 0.99);
  figures.max_ms = NearestRank(latencies_ms, 1);
  figures.hit_rate = Share(hits, misses);
  figures.buckets = Buckets(samples, figures.seconds);
  return figures;
}

nlohmann::json LoadJson(const LoadFigures& figures) {
  nlohmann::json over_time = nlohmann::json::array();
  for (const LoadBucket& bucket : figures.buckets) {
    over_time.push_back({{"from_s", bucket.from_s},
                         {"to_s", bucket.to_s},
                         {"frames", bucket.frames},
                         {"hit_rate", bucket.hit_rate}});
  }
  return {{"frames", figures.frames},
          {"seconds", figures.seconds},
          {"frames_per_s", figures.frames_per_s},
          {"latency_ms",
           {{"p50", figures.p50_ms},
            {"p90", figures.p90_ms},
            {"p99", figures.p99_ms},
            {"max", figures.max_ms}}},
          {"hit_rate", figures.hit_rate},
          {"over_time", std::move(over_time)}};
}

std::vector<Plot> LoadPlots(const LoadFigures& figures, const std::string& title) {
  PlotSeries hit_rate{"hit rate", {}};
  PlotSeries rate{"frames/s", {}};
  for (const LoadBucket& bucket : figures.buckets) {
    const double middle_s = (bucket.from_s + bucket.to_s) / 2;
    // A bucket in which no frame ended says nothing of the cache.
    if (bucket.frames > 0) hit_rate.points.emplace_back(middle_s, 100 * bucket.hit_rate);
    rate.points.emplace_back(middle_s,
                             static_cast<double>(bucket.frames) / (bucket.to_s - bucket.from_s));
  }
  const PlotAxis time{.label = "seconds", .min = 0, .max = figures.seconds};
  const PlotAxis percent{.label = "pixels that hit, %", .min = 0, .max = 100};
  return {{title + ": hit rate over time", time, percent, {std::move(hit_rate)}},
          {title + ": throughput", time, {.label = "frames per second"}, {std::move(rate)}}};
}

}  // namespace linetree
