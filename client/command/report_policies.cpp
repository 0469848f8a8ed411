// Section: what eviction policies make of a cache that is too small.
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/policy_contest.h"
#include "client/command/policy_corpus.h"
#include "client/command/report_sections.h"
#include "client/command/scene_files.h"

namespace linetree {
namespace {

using Json = nlohmann::json;

constexpr double kBudgetShares[] = {0.1, 0.25, 0.5, 0.75};
constexpr double kLeastShare = 0.25;  // that goals are for

absl::StatusOr<Json> RunPolicies(const PolicyCorpus& corpus, const Progress& progress) {
  const auto traces = RecordCorpus(corpus, [&](double share) { progress(0.8 * share); });
  if (!traces.ok()) return traces.status();
  std::vector<PolicyBudget> budgets;
  for (const double share : kBudgetShares) {
    budgets.push_back({absl::StrFormat("%g%%", 100 * share), 0, share});
  }
  std::vector<PolicyRow> rows;
  double done = 0;
  for (const auto& [name, trace] : *traces) {
    const auto more = SimulateAll(name, trace, ContestPolicies(), budgets, false, [](double) {});
    if (!more.ok()) return more.status();
    rows.insert(rows.end(), more->begin(), more->end());
    progress(0.8 + 0.2 * ++done / static_cast<double>(traces->size()));
  }
  return Json{{"rows", PolicyJson(rows)}};
}

std::vector<Plot> PoliciesPlots(const Json& result) {
  Plot hits{"hit rate against the budget, mean of all traces",
            {.label = "budget by the working set"},
            {.label = "hit rate", .min = 0, .max = 1},
            {}};
  Plot costs{"cost of rebuilding by the clairvoyant bound (1), all traces together",
             {.label = "budget by the working set"},
             {.label = "by the bound", .logarithmic = true, .min = 1},
             {}};
  for (const auto& [policy, by_share] : SumUp(PolicyRows(result.at("rows")))) {
    PlotSeries hit{policy, {}}, cost{policy, {}};
    for (const auto& [share, sums] : by_share) {
      hit.points.emplace_back(share, sums.hits / static_cast<double>(sums.traces));
      cost.points.emplace_back(share, sums.Regret());
    }
    hits.series.push_back(std::move(hit));
    costs.series.push_back(std::move(cost));
  }
  return {hits, costs};
}

std::vector<ReportTable> PoliciesTables(const Json& result) {
  ReportTable table{{"policy"}};
  for (const double share : kBudgetShares) {
    table.titles.push_back(absl::StrFormat("%g %%: cost by the bound (worst trace)", 100 * share));
  }
  for (const auto& [policy, by_share] : SumUp(PolicyRows(result.at("rows")))) {
    std::vector<std::string> row = {policy};
    for (const auto& [share, sums] : by_share) {
      row.push_back(absl::StrFormat("%.2f (%.2f)", sums.Regret(), sums.worst));
    }
    table.rows.push_back(std::move(row));
  }
  return {table};
}

std::vector<ReportGoal> PoliciesGoals(const Json& result) {
  std::vector<PolicyRow> rows = PolicyRows(result.at("rows"));
  std::erase_if(rows, [](const PolicyRow& row) { return row.share < kLeastShare; });
  const std::vector<PolicyContest> contests = ContestsOf(rows);
  const auto [near, not_worse] = CountGoals(contests);
  return {
      {"the best policy's cost by the clairvoyant bound, budgets of 25, 50 and 75 %",
       absl::StrFormat("at most %.2f in all %d", kMostRegret, contests.size()),
       absl::StrFormat("in %d", near), near == contests.size()},
      {"our policy's cost by LRU's", absl::StrFormat("at most %.2f in all", kMostByLru),
       absl::StrFormat("in %d of %d", not_worse, contests.size()), not_worse == contests.size()}};
}

}  // namespace

ReportSection PoliciesSection(const ReportOptions& options) {
  PolicyCorpus corpus{.scenes = CorpusScenes(options.scenes_dir),
                      .patterns = AllFlightPatterns(),
                      .frames = options.quick ? 24 : 160,
                      .threads = options.threads};
  corpus.size.width = corpus.size.height = options.quick ? 64 : 192;
  if (options.quick) corpus.scenes.resize(1);
  ReportSection section{.id = "policies", .title = "Eviction policies"};
  section.text =
      "What sessions use of a cache that is large enough is recorded for seven patterns of "
      "flights, "
      "and replayed with every policy in caches that are too small. The clairvoyant bound is what "
      "no policy can do better than; belady knows the future, but neither costs nor sizes.";
  section.command = absl::StrCat("linetree bench policies --frames ", corpus.frames, " --width ",
                                 corpus.size.width, " --height ", corpus.size.height);
  section.parameters = {{"frames", corpus.frames}, {"side", corpus.size.width}};
  for (const std::string& file : corpus.scenes) {
    section.parameters["files"][file] = HashOfFile(file);
  }
  section.run = [corpus](const Progress& progress) { return RunPolicies(corpus, progress); };
  section.plots = PoliciesPlots;
  section.tables = PoliciesTables;
  section.goals = PoliciesGoals;
  return section;
}

}  // namespace linetree
