// What `linetree bench speed` found, as tables, JSON and plots.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "client/command/speed_run.h"
#include "core/io/svg_plot.h"

namespace linetree {

// Packets against the scalar tracer: rows that have `tracers`.
std::string TracerTable(const std::vector<SpeedRow>& rows);
// Cached frames against classical ones, a line for every path; `point` names the sweep's column,
// empty: none.
std::string PathTable(const std::vector<SpeedRow>& rows, const std::string& point = "");
// Rows that have `stages`.
std::string StageTable(const std::vector<SpeedRow>& rows);
std::string TargetTable(const std::vector<TargetResult>& results);

nlohmann::json SpeedJson(const SpeedRow& row);
nlohmann::json TargetJson(const TargetResult& result);
nlohmann::json MemoryJson(const std::vector<MemoryPart>& parts);

// Over the points of a sweep, a line for every scene and path: ratio, time (also classical, of the
// first path) and error.
std::vector<Plot> SweepPlots(Sweep sweep, const std::vector<SpeedRow>& rows);

}  // namespace linetree
