// The measurements behind the paper's Tables 1, 2 and 3, and the printed figures beside them.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/cache/cache_options.h"
#include "core/io/compare.h"
#include "core/render/scene_host.h"

namespace linetree {

// Intersect or Shade counts (section 8) in thousands: base for rays that were traced, ip for
// building interpolants, classical without a cache.
struct PaperCounts {
  double base = 0, ip = 0, classical = 0;
  // As the paper prints it; several of its ratios do not follow from the counts beside them.
  double printed_ratio = 0;

  double Total() const { return base + ip; }
  double Ratio() const {
    if (printed_ratio > 0) return printed_ratio;
    return classical > 0 ? Total() / classical : 0;
  }
};

// A row as the paper prints it, or as measured.
struct PaperRow {
  std::string label;
  PaperCounts intersect, shade;
  double success = 0;  // share of the pixels that hit an object which a cell answered
};

struct MeasuredRow {
  PaperRow row;
  FrameStats stats;
  ErrorFigures error;  // of the cached frame against the classical one
};

// What is measured: a scene's cameras frame1 ... frame5 in turn at one epsilon, from a cold cache.
struct SequenceSpec {
  std::string title;
  std::string scene_file;
  double epsilon = 0;
  std::vector<PaperRow> printed;
};
struct Sequence {
  SequenceSpec spec;
  std::vector<MeasuredRow> rows;
};

struct PaperBenchOptions {
  int width = 512;
  int height = 512;
  int threads = 0;
  CacheOptions cache;
  std::string scenes_dir = "scenes";
};

// Tables 1 and 2 at the epsilon of the caption and that of the text, and Table 3 (first frames of
// the room at several epsilons).
std::vector<SequenceSpec> PaperSequences(const std::string& scenes_dir);
SequenceSpec PaperEpsilonSweep(const std::string& scenes_dir, const PaperRow& printed,
                               double epsilon);
std::vector<std::pair<double, PaperRow>> PrintedEpsilonRows();

// Renders the named cameras; the cache lives across them.
absl::StatusOr<Sequence> MeasureSequence(const SequenceSpec& spec,
                                         const std::vector<std::string>& cameras,
                                         const PaperBenchOptions& options, WorkerPool& pool);

std::string SequenceText(const Sequence& sequence);
nlohmann::json SequenceJson(const Sequence& sequence);

}  // namespace linetree
