// What a load test measured: every frame in, figures out.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/io/svg_plot.h"

namespace linetree {

// One frame that a client asked for. Times are seconds since the test began.
struct LoadSample {
  double start_s = 0;
  double end_s = 0;   // when the whole frame had arrived
  uint64_t hits = 0;  // pixels that needed no search of the scene but for the eye ray's hit
  uint64_t misses = 0;
};

// Frames that ended in [from_s, to_s); the last bucket includes its end.
struct LoadBucket {
  double from_s = 0;
  double to_s = 0;
  uint64_t frames = 0;
  double hit_rate = 0;  // over all pixels of these frames that hit something; 0 without any
};

struct LoadFigures {
  uint64_t frames = 0;
  double seconds = 0;  // until the last frame had arrived
  double frames_per_s = 0;
  // Latencies: nearest ranks over all frames.
  double p50_ms = 0;
  double p90_ms = 0;
  double p99_ms = 0;
  double max_ms = 0;
  double hit_rate = 0;
  std::vector<LoadBucket> buckets;  // of equal length
};

inline constexpr int kLoadBuckets = 20;

// All zero without samples.
LoadFigures SummarizeLoad(const std::vector<LoadSample>& samples);

// The smallest element that at least the given share of all do not exceed; 0 without any. share in
// (0, 1].
double NearestRank(std::vector<double> values, double share);

nlohmann::json LoadJson(const LoadFigures& figures);
// Hit rate and frames per second over time.
std::vector<Plot> LoadPlots(const LoadFigures& figures, const std::string& title);

}  // namespace linetree
