// Section: what eviction policies make of a cache that is too small.
#include <map>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/policy_report.h"
#include "client/command/report_sections.h"
#include "client/command/scene_files.h"
#include "client/command/session.h"
#include "core/audit/flight_corpus.h"
#include "core/policy/simulate.h"

namespace linetree {
namespace {

using Json = nlohmann::json;

constexpr const char* kScenes[] = {"room.textproto", "spd/balls_3.nff", "spd/tree_8.nff",
                                   "many_lights.textproto"};
constexpr double kShares[] = {0.1, 0.25, 0.5, 0.75};
// Goals: the best policy's cost by the bound, and ours by LRU's.
constexpr double kMostRegret = 1.15;
constexpr double kMostByLru = 1.05;

struct Setting {
  std::string folder;
  int frames = 0, side = 0, threads = 0;
  size_t scenes = 0;
};

absl::StatusOr<std::vector<PolicyRow>> Contest(const Setting& setting, const char* scene,
                                               FlightPattern pattern, WorkerPool& pool) {
  const auto file = ReadSceneFileChecked(absl::StrCat(setting.folder, "/", scene));
  if (!file.ok()) return file.status();
  FlightTraceOptions options{setting.side, setting.side, {}};
  const auto views = FlightViews(*file->scene, file->scene->cameras.at(0), pattern, setting.frames);
  const auto trace = RecordFlight(file->scene, views, options, pool, [](double) {});
  if (!trace.ok()) return trace.status();
  std::vector<PolicyBudget> budgets;
  for (const double share : kShares) {
    budgets.push_back({absl::StrFormat("%g%%", 100 * share), 0, share});
  }
  const std::string name = absl::StrCat(
      file->name, ", ", std::string(kFlightPatternNames[static_cast<size_t>(pattern)]));
  return SimulateAll(name, *trace, *ParsePolicies("all"), budgets, false, [](double) {});
}

Json RowJson(const PolicyRow& row) {
  return {{"trace", row.trace},
          {"policy", row.policy},
          {"share", row.share},
          {"hit_ratio", row.result.HitRatio()},
          {"rebuild_ns", row.result.rebuild_ns},
          {"least_rebuild_ns", row.least_rebuild_ns}};
}

// A value for each policy and share, of all traces together.
struct Sums {
  double hits = 0, traces = 0, cost = 0, least = 0, worst = 0;
};
using SumsByPolicy = std::map<std::string, std::map<double, Sums>>;

double RegretOf(const Json& row) {
  const double least = row.at("least_rebuild_ns");
  return least > 0 ? row.at("rebuild_ns").get<double>() / least : 1;
}

SumsByPolicy SumUp(const Json& result) {
  SumsByPolicy policies;
  for (const Json& row : result.at("rows")) {
    Sums& sums = policies[row.at("policy")][row.at("share")];
    sums.hits += row.at("hit_ratio").get<double>();
    sums.traces += 1;
    sums.cost += row.at("rebuild_ns").get<double>();
    sums.least += row.at("least_rebuild_ns").get<double>();
    sums.worst = std::max(sums.worst, RegretOf(row));
  }
  return policies;
}

std::vector<Plot> Plots(const Json& result) {
  Plot hits{"hit rate against the budget, mean of all traces",
            {.label = "budget by the working set"},
            {.label = "hit rate", .min = 0, .max = 1},
            {}};
  Plot costs{"cost of rebuilding by the clairvoyant bound (1), all traces together",
             {.label = "budget by the working set"},
             {.label = "by the bound", .logarithmic = true, .min = 1},
             {}};
  for (const auto& [policy, by_share] : SumUp(result)) {
    PlotSeries hit{policy, {}}, cost{policy, {}};
    for (const auto& [share, sums] : by_share) {
      hit.points.emplace_back(share, sums.hits / sums.traces);
      cost.points.emplace_back(share, sums.least > 0 ? sums.cost / sums.least : 1);
    }
    hits.series.push_back(std::move(hit));
    costs.series.push_back(std::move(cost));
  }
  return {hits, costs};
}

std::vector<ReportTable> Tables(const Json& result) {
  ReportTable table{{"policy"}};
  for (const double share : kShares) {
    table.titles.push_back(absl::StrFormat("%g %%: cost by the bound (worst trace)", 100 * share));
  }
  for (const auto& [policy, by_share] : SumUp(result)) {
    std::vector<std::string> row = {policy};
    for (const auto& [share, sums] : by_share) {
      row.push_back(
          absl::StrFormat("%.2f (%.2f)", sums.least > 0 ? sums.cost / sums.least : 1, sums.worst));
    }
    table.rows.push_back(std::move(row));
  }
  return {table};
}

std::vector<ReportGoal> Goals(const Json& result) {
  std::map<std::pair<std::string, double>, double> best, ours, lru;
  for (const Json& row : result.at("rows")) {
    const std::pair<std::string, double> contest = {row.at("trace"), row.at("share")};
    // The goals are for a quarter of the working set and more.
    if (contest.second < 0.25 || row.at("policy") == kBelady) continue;
    const double regret = RegretOf(row);
    const auto [found, is_new] = best.emplace(contest, regret);
    if (!is_new) found->second = std::min(found->second, regret);
    if (row.at("policy") == "reuse") ours[contest] = regret;
    if (row.at("policy") == "lru") lru[contest] = regret;
  }
  size_t near = 0, not_worse = 0;
  for (const auto& [contest, regret] : best) {
    near += regret <= kMostRegret ? 1 : 0;
    not_worse += ours[contest] <= kMostByLru * lru[contest] ? 1 : 0;
  }
  return {{"the best policy's cost by the clairvoyant bound, budgets of 25, 50 and 75 %",
           absl::StrFormat("at most %.2f in all %d", kMostRegret, best.size()),
           absl::StrFormat("in %d", near), near == best.size()},
          {"our policy's cost by LRU's", absl::StrFormat("at most %.2f in all", kMostByLru),
           absl::StrFormat("in %d of %d", not_worse, best.size()), not_worse == best.size()}};
}

}  // namespace

ReportSection PoliciesSection(const ReportOptions& options) {
  const Setting setting{options.scenes_dir, options.quick ? 24 : 160, options.quick ? 64 : 192,
                        options.threads, options.quick ? size_t{1} : std::size(kScenes)};
  ReportSection section{.id = "policies", .title = "Eviction policies"};
  section.text =
      "What sessions use of a cache that is large enough is recorded for seven patterns of "
      "flights, "
      "and replayed with every policy in caches that are too small. The clairvoyant bound is what "
      "no policy can do better than; belady knows the future, but neither costs nor sizes.";
  section.command = absl::StrCat("linetree bench policies --frames ", setting.frames, " --width ",
                                 setting.side, " --height ", setting.side);
  section.parameters = {{"frames", setting.frames}, {"side", setting.side}};
  for (size_t i = 0; i < setting.scenes; ++i) {
    const std::string file = absl::StrCat(setting.folder, "/", kScenes[i]);
    section.parameters["files"][file] = HashOfFile(file);
  }
  section.run = [setting](const Progress& progress) -> absl::StatusOr<Json> {
    WorkerPool pool(setting.threads);
    Json rows = Json::array();
    double done = 0;
    for (size_t i = 0; i < setting.scenes; ++i) {
      for (size_t pattern = 0; pattern < kFlightPatternNames.size(); ++pattern) {
        const auto more = Contest(setting, kScenes[i], static_cast<FlightPattern>(pattern), pool);
        if (!more.ok()) return more.status();
        for (const PolicyRow& row : *more) rows.push_back(RowJson(row));
        progress(++done / static_cast<double>(setting.scenes * kFlightPatternNames.size()));
      }
    }
    return Json{{"rows", std::move(rows)}};
  };
  section.plots = Plots;
  section.tables = Tables;
  section.goals = Goals;
  return section;
}

}  // namespace linetree
