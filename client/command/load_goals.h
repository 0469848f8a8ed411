// Figures of a load test by name: what it is to reach, and what has changed since another run.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/command/load_report.h"

namespace linetree {

struct LoadMetric {
  const char* name;
  bool more_is_better;
  double (*value)(const LoadFigures&);
};
const std::vector<LoadMetric>& LoadMetrics();

// Their values by name: the member "metrics" of what `load --stats` writes.
nlohmann::json MetricsJson(const LoadFigures& figures);

// At least, or at most where less is better.
struct LoadObjective {
  const LoadMetric* metric = nullptr;
  double bound = 0;
};

// "p99_ms=50". Errors list the names.
absl::StatusOr<LoadObjective> ParseObjective(const std::string& text);
bool IsMet(const LoadObjective& objective, const LoadFigures& figures);

// A line for each: what was wanted and what came. "" for none.
std::string ObjectiveTable(const std::vector<LoadObjective>& objectives,
                           const LoadFigures& figures);
nlohmann::json ObjectivesJson(const std::vector<LoadObjective>& objectives,
                              const LoadFigures& figures);

// One metric of two runs.
struct MetricChange {
  const LoadMetric* metric = nullptr;
  double before = 0;
  double now = 0;

  double Difference() const { return now - before; }
  // "better", "worse" or "equal".
  const char* Judgement() const;
};

// Of the metrics that both have. INVALID_ARGUMENT for what `load --stats` has not written.
absl::StatusOr<std::vector<MetricChange>> CompareLoads(const nlohmann::json& before,
                                                       const LoadFigures& now);
std::string ChangeTable(const std::vector<MetricChange>& changes);
nlohmann::json ChangesJson(const std::vector<MetricChange>& changes);

}  // namespace linetree
