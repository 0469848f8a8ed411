#include "client/command/policy_report.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <optional>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "client/command/table.h"
#include "core/policy/clairvoyant.h"
#include "core/policy/policies.h"

namespace linetree {
namespace {

// The budget in bytes (or items), and its share of the working set.
std::pair<uint64_t, double> Resolve(const PolicyBudget& budget, uint64_t working_set) {
  const auto all = static_cast<double>(working_set);
  if (budget.share == 0) {
    return {budget.bytes, all > 0 ? static_cast<double>(budget.bytes) / all : 0};
  }
  return {static_cast<uint64_t>(std::llround(budget.share * all)), budget.share};
}

void Extend(std::vector<Plot>& plots, size_t first, const PolicyRow& row) {
  const double percent = 100 * row.share;
  const std::pair<double, double> points[] = {{percent, 100 * row.result.HitRatio()},
                                              {percent, row.Regret()}};
  for (size_t i = 0; i < 2; ++i) {
    auto& series = plots[first + i].series;
    if (series.empty() || series.back().name != row.policy) series.push_back({row.policy, {}});
    series.back().points.push_back(points[i]);
  }
}

// A policy's name, and how many frames ahead it is told the future.
struct ToldPolicy {
  std::string name;
  uint32_t frames = 0;
};
std::optional<ToldPolicy> SplitPolicy(const std::string& text) {
  const std::pair<std::string, std::string> parts = absl::StrSplit(text, absl::MaxSplits('@', 1));
  ToldPolicy told{parts.first};
  const bool has_frames = absl::StrContains(text, '@');
  if (has_frames && (!absl::SimpleAtoi(parts.second, &told.frames) || told.frames == 0)) {
    return std::nullopt;
  }
  return told;
}

}  // namespace

absl::StatusOr<PolicyBudget> ParseBudget(const std::string& text) {
  PolicyBudget budget{.text = text};
  absl::string_view number = text;
  if (absl::ConsumeSuffix(&number, "%")) {
    if (absl::SimpleAtod(number, &budget.share) && budget.share > 0 && budget.share <= 1000) {
      budget.share /= 100;
      return budget;
    }
  } else {
    std::string word = text;
    // As --memory reads it.
    if (CLI::AsSizeValue(false)(word).empty() && absl::SimpleAtoi(word, &budget.bytes)) {
      return budget;
    }
  }
  return absl::InvalidArgumentError(absl::StrCat(
      "expected bytes (1000000, 64m) or a share of the working set (25%), found '", text, "'"));
}

bool PolicyRow::IsClairvoyant() const {
  return policy == kBelady || absl::StrContains(policy, '@');
}

absl::StatusOr<std::vector<std::string>> ParsePolicies(const std::string& text) {
  std::vector<std::string> names;
  for (const PolicyNote& note : AllPolicies()) names.emplace_back(note.name);
  names.emplace_back(kBelady);
  if (text == "all") return names;
  std::vector<std::string> chosen = absl::StrSplit(text, ',');
  for (const std::string& name : chosen) {
    const auto told = SplitPolicy(name);
    if (told && std::find(names.begin(), names.end(), told->name) != names.end()) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("unknown policy '", name, "', expected all or some of ", PolicyNames(), ", ",
                     std::string(kBelady), ", each with @FRAMES behind it or without"));
  }
  return chosen;
}

absl::StatusOr<std::vector<PolicyRow>> SimulateAll(const std::string& name, const Trace& trace,
                                                   const std::vector<std::string>& policies,
                                                   const std::vector<PolicyBudget>& budgets,
                                                   bool ignores_size,
                                                   const std::function<void(double)>& progress) {
  const WorkingSet set = WorkingSetOf(trace);
  std::vector<PolicyRow> rows;
  const auto steps = static_cast<double>(budgets.size() * (policies.size() + 1));
  double done = 0;
  std::vector<double> least;
  for (const PolicyBudget& budget : budgets) {
    const auto [bytes, share] = Resolve(budget, ignores_size ? set.items : set.bytes);
    least.push_back(LeastRebuildCost(trace, bytes, ignores_size));
    progress(++done / steps);
  }
  for (const std::string& policy : policies) {
    for (size_t b = 0; b < budgets.size(); ++b) {
      const auto [bytes, share] = Resolve(budgets[b], ignores_size ? set.items : set.bytes);
      const auto told = SplitPolicy(policy);
      const auto result =
          told ? Simulate(trace, told->name, {bytes, ignores_size, told->frames})
               : absl::InvalidArgumentError(absl::StrCat("unknown policy '", policy, "'"));
      if (!result.ok()) return result.status();
      rows.push_back({name, policy, budgets[b].text, share, bytes, *result, least[b]});
      progress(++done / steps);
    }
  }
  return rows;
}

std::string PolicyTable(const std::vector<PolicyRow>& rows) {
  Table table({{"trace"},
               {"policy"},
               {"budget", Align::kRight},
               {"in units", Align::kRight},
               {"hits", Align::kRight},
               {"bytes hit", Align::kRight},
               {"evicted", Align::kRight},
               {"rebuild ms", Align::kRight},
               {"/ bound", Align::kRight}});
  for (const PolicyRow& row : rows) {
    table.AddRow({row.trace, row.policy, row.budget, Grouped(row.budget_bytes),
                  absl::StrFormat("%.2f %%", 100 * row.result.HitRatio()),
                  absl::StrFormat("%.2f %%", 100 * row.result.ByteHitRatio()),
                  Grouped(row.result.evictions),
                  absl::StrFormat("%.3f", row.result.rebuild_ns / 1e6),
                  absl::StrFormat("%.3f", row.Regret())});
  }
  return table.ToString();
}

nlohmann::json PolicyJson(const std::vector<PolicyRow>& rows) {
  nlohmann::json json = nlohmann::json::array();
  for (const PolicyRow& row : rows) {
    json.push_back({{"trace", row.trace},
                    {"policy", row.policy},
                    {"budget", row.budget},
                    {"share", row.share},
                    {"budget_bytes", row.budget_bytes},
                    {"requests", row.result.requests},
                    {"hits", row.result.hits},
                    {"requested_bytes", row.result.requested_bytes},
                    {"hit_bytes", row.result.hit_bytes},
                    {"hit_ratio", row.result.HitRatio()},
                    {"byte_hit_ratio", row.result.ByteHitRatio()},
                    {"evictions", row.result.evictions},
                    {"rebuild_ns", row.result.rebuild_ns},
                    {"least_rebuild_ns", row.least_rebuild_ns},
                    {"regret", row.Regret()}});
  }
  return json;
}

std::vector<PolicyRow> PolicyRows(const nlohmann::json& json) {
  std::vector<PolicyRow> rows;
  for (const nlohmann::json& of : json) {
    PolicyRow row{of.at("trace"),           of.at("policy"),       of.at("budget"),
                  of.at("share"),           of.at("budget_bytes"), {},
                  of.at("least_rebuild_ns")};
    row.result.requests = of.at("requests");
    row.result.hits = of.at("hits");
    row.result.evictions = of.at("evictions");
    row.result.requested_bytes = of.at("requested_bytes");
    row.result.hit_bytes = of.at("hit_bytes");
    row.result.rebuild_ns = of.at("rebuild_ns");
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<Plot> PolicyPlots(const std::vector<PolicyRow>& rows) {
  std::vector<Plot> plots;
  std::string trace;
  for (const PolicyRow& row : rows) {
    if (plots.empty() || row.trace != trace) {
      trace = row.trace;
      const PlotAxis budget{.label = "budget, % of the working set"};
      plots.push_back({trace + ": hits", budget, {.label = "hit ratio, %"}, {}});
      plots.push_back(
          {trace + ": rebuild cost", budget, {.label = "times the clairvoyant bound"}, {}});
    }
    Extend(plots, plots.size() - 2, row);
  }
  for (size_t i = 1; i < plots.size(); i += 2) {
    PlotSeries bound{"bound", {}};
    for (const auto& [x, y] : plots[i].series.front().points) bound.points.emplace_back(x, 1.0);
    plots[i].series.push_back(std::move(bound));
  }
  return plots;
}

}  // namespace linetree
