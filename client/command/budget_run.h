// Frames of caches that are far too small against frames without: what is flown, and what it says.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "client/command/policy_corpus.h"
#include "client/command/report_section.h"
#include "core/audit/budget_study.h"

namespace linetree {

// To reach: no flight takes longer than so many times what it takes without a cache.
inline constexpr double kMostByNone = 1.05;

struct BudgetPlan {
  PolicyCorpus corpus;  // its size, error and threads as well
  std::vector<Lanes> lanes = {Lanes::kScalar, Lanes::kSimd};
  double share = 0.05;  // of the working set
  int repeats = 3;
};

// A row for every scene, pattern and lanes, as BudgetTable and BudgetGoal read them.
absl::StatusOr<nlohmann::json> RunBudgets(const BudgetPlan& plan, const Progress& progress);

ReportTable BudgetTable(const nlohmann::json& rows);
std::vector<ReportGoal> BudgetGoals(const nlohmann::json& rows);

}  // namespace linetree
