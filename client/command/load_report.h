// What a load test measured: every frame in, figures out.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/io/svg_plot.h"
#include "core/render/frame.h"

namespace linetree {

// One frame that a client asked for. Times are seconds since its phase began.
struct LoadSample {
  size_t client = 0;
  size_t frame = 0;       // of this client
  double intended_s = 0;  // when it was to begin
  double start_s = 0;     // when it began: later where no client was free
  double end_s = 0;       // when the whole frame, or its refusal, had arrived
  bool late = false;      // no client was free when it was to begin
  bool refused = false;   // for want of room; what follows is then zero
  FrameTiming timing{};
  uint64_t wire_bytes = 0;
  FrameStats stats{};
};

// What is reported together: frames before the caches are warm, and those that count.
struct LoadPhase {
  std::string name{};
  std::vector<LoadSample> samples{};
  std::vector<double> light_calls_ms{};  // how long GetStats took meanwhile
  uint64_t not_begun = 0;    // were to begin before the time was up, but no client was free
  uint64_t overtaken = 0;    // viewpoints that a newer one has left without a frame
  uint64_t cells_built = 0;  // of all trees of the scene, since the phase before
  uint64_t cells_evicted = 0;
};

struct Quantiles {
  double p50 = 0;
  double p90 = 0;
  double p99 = 0;
  double max = 0;
};

// Pixels by where their answers came from.
struct SourceCounts {
  uint64_t interpolated = 0;
  uint64_t replayed = 0;
  uint64_t residual = 0;
  uint64_t traced = 0;  // without any help of the cache

  uint64_t Sum() const { return interpolated + replayed + residual + traced; }
  // Of `part` among all of these pixels; 0 without any.
  double Share(uint64_t part) const;
  // Of those that needed no search of the scene but for the eye ray's hit.
  double HitRate() const { return Share(interpolated + replayed); }
};

// Frames that ended in [from_s, to_s); the last bucket includes its end.
struct LoadBucket {
  double from_s = 0;
  double to_s = 0;
  uint64_t frames = 0;
  SourceCounts sources;
};

struct LoadFigures {
  std::string phase{};
  uint64_t frames = 0;  // that were answered
  uint64_t refused = 0;
  uint64_t late = 0;
  uint64_t not_begun = 0;
  uint64_t overtaken = 0;
  double seconds = 0;  // until the last frame had arrived
  double frames_per_s = 0;
  // Over all frames that were answered, in ms. Latency runs from when the frame was to begin, and
  // is the sum of the other five for each frame, though not for their quantiles.
  Quantiles latency{}, wait{}, queue{}, render{}, encode{}, network{};
  Quantiles light{};  // of calls that render nothing, in ms
  uint64_t light_calls = 0;
  SourceCounts sources{};
  uint64_t wire_bytes = 0;
  uint64_t cells_built = 0;
  uint64_t cells_evicted = 0;
  uint64_t cache_bytes = 0;           // at the end
  std::vector<LoadBucket> buckets{};  // of equal length
};

inline constexpr int kLoadBuckets = 20;

// All zero without samples.
LoadFigures SummarizeLoad(const LoadPhase& phase);

// The smallest element that at least the given share of all do not exceed; 0 without any. share in
// (0, 1].
double NearestRank(std::vector<double> values, double share);
// By nearest ranks.
Quantiles QuantilesOf(std::vector<double> values);

// What went between the server and the client, and what the client itself needed.
double NetworkMs(const LoadSample& sample);

nlohmann::json LoadJson(const LoadFigures& figures);
// A line for each frame of all phases, with titles.
std::string LoadCsv(const std::vector<LoadPhase>& phases);
// Answers by source, throughput and latencies over time; latencies by their parts.
std::vector<Plot> LoadPlots(const LoadPhase& phase, const LoadFigures& figures,
                            const std::string& title);

}  // namespace linetree
