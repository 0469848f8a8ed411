// A load test for readers: text for a terminal, and one HTML page.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "client/command/load_goals.h"
#include "client/command/load_report.h"
#include "client/command/provenance.h"

namespace linetree {

// A finished load test. Figures are those of the phases, in their order; the last one counts.
struct LoadResult {
  std::string title{};
  std::vector<LoadPhase> phases{};
  std::vector<LoadFigures> figures{};
  std::vector<LoadObjective> objectives{};
  std::vector<MetricChange> changes{};  // since the run that it is compared with, if any
  Provenance provenance{};

  const LoadFigures& measured() const { return figures.back(); }
  bool MeetsObjectives() const;
};

// Tables.
std::string LoadText(const LoadResult& result);
// The figures that count at the top, those of the warm-up as "warm_up", "metrics" by name.
nlohmann::json LoadResultJson(const LoadResult& result);
std::vector<Plot> LoadResultPlots(const LoadResult& result);
std::string LoadHtml(const LoadResult& result);

}  // namespace linetree
