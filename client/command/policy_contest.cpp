#include "client/command/policy_contest.h"

#include <algorithm>
#include <utility>

namespace linetree {
namespace {

constexpr char kOurs[] = "reuse";
constexpr char kLru[] = "lru";

}  // namespace

std::vector<std::string> ContestPolicies() {
  std::vector<std::string> policies = *ParsePolicies("all");
  policies.insert(policies.end(), {"reuse@2", "reuse@8", "reuse@32"});
  return policies;
}

std::vector<PolicyContest> ContestsOf(const std::vector<PolicyRow>& rows) {
  std::map<std::pair<std::string, std::string>, PolicyContest> all;
  for (const PolicyRow& row : rows) {
    PolicyContest& contest = all[{row.trace, row.budget}];
    contest.trace = row.trace;
    contest.budget = row.budget;
    if (row.policy == kOurs) contest.ours = row.Regret();
    if (row.policy == kLru) contest.lru = row.Regret();
    if (row.IsClairvoyant()) continue;
    if (contest.best == nullptr || row.Regret() < contest.best->Regret()) contest.best = &row;
  }
  std::vector<PolicyContest> contests;
  for (const auto& [key, contest] : all) contests.push_back(contest);
  return contests;
}

ContestGoals CountGoals(const std::vector<PolicyContest>& contests) {
  ContestGoals goals;
  for (const PolicyContest& contest : contests) {
    goals.near += contest.best->Regret() <= kMostRegret ? 1 : 0;
    goals.not_worse += contest.ByLru() <= kMostByLru ? 1 : 0;
  }
  return goals;
}

std::map<std::string, std::map<double, PolicySums>> SumUp(const std::vector<PolicyRow>& rows) {
  std::map<std::string, std::map<double, PolicySums>> policies;
  for (const PolicyRow& row : rows) {
    PolicySums& sums = policies[row.policy][row.share];
    sums.hits += row.result.HitRatio();
    sums.traces += 1;
    sums.cost += row.result.rebuild_ns;
    sums.least += row.least_rebuild_ns;
    sums.worst = std::max(sums.worst, row.Regret());
  }
  return policies;
}

}  // namespace linetree
