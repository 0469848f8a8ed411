// What simulations of eviction policies say: tables, JSON and plots.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/io/svg_plot.h"
#include "core/policy/simulate.h"

namespace linetree {

// A budget as it was asked for: bytes, or a share of the working set.
struct PolicyBudget {
  std::string text;
  uint64_t bytes = 0;
  double share = 0;  // where not 0, of the working set
};

// "25%", "64m", "1000"; INVALID_ARGUMENT for anything else.
absl::StatusOr<PolicyBudget> ParseBudget(const std::string& text);

// "all", or names with commas between them, "belady" among them, and "NAME@8" for a policy that is
// told what is used within 8 frames (SimulationOptions::foresight_frames); INVALID_ARGUMENT for
// others. "all" has none of these.
absl::StatusOr<std::vector<std::string>> ParsePolicies(const std::string& text);

// One policy on one trace under one budget.
struct PolicyRow {
  std::string trace;
  std::string policy;
  std::string budget;
  double share = 0;  // of the working set
  uint64_t budget_bytes = 0;
  SimulationResult result;
  double least_rebuild_ns = 0;  // LeastRebuildCost

  // Knows the future, or some of it.
  bool IsClairvoyant() const;
  double Regret() const { return least_rebuild_ns > 0 ? result.rebuild_ns / least_rebuild_ns : 1; }
};

// Every policy under every budget; budgets in items where sizes are ignored.
absl::StatusOr<std::vector<PolicyRow>> SimulateAll(const std::string& name, const Trace& trace,
                                                   const std::vector<std::string>& policies,
                                                   const std::vector<PolicyBudget>& budgets,
                                                   bool ignores_size,
                                                   const std::function<void(double)>& progress);

std::string PolicyTable(const std::vector<PolicyRow>& rows);
nlohmann::json PolicyJson(const std::vector<PolicyRow>& rows);
std::vector<PolicyRow> PolicyRows(const nlohmann::json& json);  // what PolicyJson has written
// Hit ratio and rebuild cost over the budget, a series for each policy, for every trace.
std::vector<Plot> PolicyPlots(const std::vector<PolicyRow>& rows);

}  // namespace linetree
