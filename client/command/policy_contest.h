// Which policy does best: contests under one budget on one trace, and sums over all traces.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "client/command/policy_report.h"

namespace linetree {

// Goals: the best policy's cost by the bound, and ours by LRU's.
inline constexpr double kMostRegret = 1.15;
inline constexpr double kMostByLru = 1.05;

// All policies, and ours as it would be if it knew where viewpoints are heading: the roofline of
// any prediction.
std::vector<std::string> ContestPolicies();

// Of one trace under one budget.
struct PolicyContest {
  std::string trace, budget;
  const PolicyRow* best = nullptr;  // that does not know the future
  double ours = 1, lru = 1;         // costs by the bound

  double ByLru() const { return ours / lru; }
};
// They point into the rows.
std::vector<PolicyContest> ContestsOf(const std::vector<PolicyRow>& rows);

// In how many contests the goals are met.
struct ContestGoals {
  size_t near = 0, not_worse = 0;
};
ContestGoals CountGoals(const std::vector<PolicyContest>& contests);

// Of one policy under one budget, all traces together.
struct PolicySums {
  double hits = 0;  // sum of hit ratios
  size_t traces = 0;
  double cost = 0, least = 0;  // ns
  double worst = 0;            // regret of any trace

  double Regret() const { return least > 0 ? cost / least : 1; }
};
// By policy and share of the working set.
std::map<std::string, std::map<double, PolicySums>> SumUp(const std::vector<PolicyRow>& rows);

}  // namespace linetree
