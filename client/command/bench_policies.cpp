// linetree bench policies: eviction policies on recorded flights.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/command.h"
#include "client/command/flags.h"
#include "client/command/output.h"
#include "client/command/policy_contest.h"
#include "client/command/policy_flags.h"
#include "client/command/progress_bar.h"
#include "client/command/table.h"
#include "core/io/atomic_file.h"
#include "core/io/trace_file.h"

namespace linetree {
namespace {

struct BenchPoliciesFlags {
  PolicyCorpus corpus{.scenes = CorpusScenes("scenes"), .patterns = AllFlightPatterns()};
  std::string traces;  // folder
  std::string json, svg;
  bool quiet = false;
};

absl::Status SaveTraces(const std::vector<NamedTrace>& traces, const std::string& folder) {
  for (const auto& [name, trace] : traces) {
    std::string file = name;
    std::replace(file.begin(), file.end(), ' ', '_');
    const auto path = (std::filesystem::path(folder) / (file + ".trace")).string();
    if (auto s = WriteTrace(trace, path); !s.ok()) return s;
  }
  return absl::OkStatus();
}

void PrintPolicies(const std::vector<PolicyRow>& rows) {
  const auto policies = SumUp(rows);
  std::vector<TableColumn> columns = {{"policy"}};
  for (const auto& [share, sums] : policies.begin()->second) {
    columns.push_back({absl::StrFormat("%g%%: all", 100 * share), Align::kRight});
    columns.push_back({"worst", Align::kRight});
  }
  Table table(std::move(columns));
  for (const auto& [policy, by_share] : policies) {
    std::vector<std::string> cells = {policy};
    for (const auto& [share, sums] : by_share) {
      cells.push_back(absl::StrFormat("%.3f", sums.Regret()));
      cells.push_back(absl::StrFormat("%.3f", sums.worst));
    }
    table.AddRow(std::move(cells));
  }
  std::cout << "Rebuild cost by the clairvoyant bound, of all traces together and of the worst:\n"
            << table.ToString() << "\n";
}

nlohmann::json PrintContests(const std::vector<PolicyContest>& contests) {
  Table table({{"trace"},
               {"budget", Align::kRight},
               {"best"},
               {"/ bound", Align::kRight},
               {"reuse / bound", Align::kRight},
               {"lru / bound", Align::kRight},
               {"reuse / lru", Align::kRight}});
  nlohmann::json json = nlohmann::json::array();
  for (const PolicyContest& contest : contests) {
    table.AddRow({contest.trace, contest.budget, contest.best->policy,
                  absl::StrFormat("%.3f", contest.best->Regret()),
                  absl::StrFormat("%.3f", contest.ours), absl::StrFormat("%.3f", contest.lru),
                  absl::StrFormat("%.3f", contest.ByLru())});
    json.push_back({{"trace", contest.trace},
                    {"budget", contest.budget},
                    {"best", contest.best->policy},
                    {"best_regret", contest.best->Regret()},
                    {"reuse_regret", contest.ours},
                    {"lru_regret", contest.lru}});
  }
  const ContestGoals goals = CountGoals(contests);
  std::cout << table.ToString() << "\n"
            << absl::StrFormat("To reach: the best policy at most %.2f x the bound: %d of %d. ",
                               kMostRegret, goals.near, contests.size())
            << absl::StrFormat("reuse at most %.2f x LRU: %d of %d.\n", kMostByLru, goals.not_worse,
                               contests.size());
  return json;
}

absl::StatusOr<int> BenchPolicies(const BenchPoliciesFlags& flags) {
  if (auto s = CheckFolders({flags.json, flags.svg, flags.traces + "/"}); !s.ok()) return s;
  std::vector<PolicyRow> rows;
  {
    ProgressBar bar(!flags.quiet && IsTerminal(), "bench policies");
    const auto traces = RecordCorpus(flags.corpus, [&](double share) { bar.Show(0.8 * share); });
    if (!traces.ok()) return traces.status();
    if (!flags.traces.empty()) {
      if (auto s = SaveTraces(*traces, flags.traces); !s.ok()) return s;
    }
    const std::vector<PolicyBudget> budgets = {*ParseBudget("25%"), *ParseBudget("50%"),
                                               *ParseBudget("75%")};
    double done = 0;
    for (const auto& [name, trace] : *traces) {
      auto more = SimulateAll(name, trace, ContestPolicies(), budgets, false, [](double) {});
      if (!more.ok()) return more.status();
      rows.insert(rows.end(), more->begin(), more->end());
      bar.Show(0.8 + 0.2 * ++done / static_cast<double>(traces->size()));
    }
  }
  PrintPolicies(rows);
  const nlohmann::json contests = PrintContests(ContestsOf(rows));
  if (!flags.json.empty()) {
    const nlohmann::json json = {{"rows", PolicyJson(rows)}, {"contests", contests}};
    if (auto s = WriteJson(json, flags.json); !s.ok()) return s;
  }
  if (!flags.svg.empty()) {
    if (auto s = WriteFileAtomically(flags.svg, SvgPlots(PolicyPlots(rows))); !s.ok()) return s;
  }
  return kExitOk;
}

void AddPoliciesFlags(CLI::App& app, BenchPoliciesFlags& flags) {
  AddCorpusFlags(app, flags.corpus);
  app.add_option("--traces", flags.traces, "Also write the traces into this folder")
      ->type_name("FOLDER");
  AddJsonFlag(app, flags.json, "the figures");
  app.add_option("--svg", flags.svg, "Also plot hits and rebuild cost over the budget")
      ->type_name("FILE")
      ->check(HasExtension({".svg"}));
  AddQuietFlag(app, flags.quiet);
}

}  // namespace

void AddBenchPolicies(CLI::App& bench, Commands& commands) {
  auto flags = std::make_shared<BenchPoliciesFlags>();
  CLI::App* app = bench.add_subcommand("policies", "Eviction policies on recorded flights");
  AddPoliciesFlags(*app, *flags);
  app->footer(
      "Records what flights through scenes use, in this process, and replays it with every policy "
      "at 25, 50 and 75 %\nof the working set. Compares what rebuilding the misses costs with the "
      "clairvoyant bound and with LRU.\n\nExamples:\n"
      "  linetree bench policies\n"
      "  linetree bench policies --scene scenes/room.textproto --flight orbit --frames 400 --svg "
      "orbit.svg\n"
      "  linetree bench policies --traces corpus --json policies.json");
  commands.push_back({app, [flags] { return BenchPolicies(*flags); }});
}

}  // namespace linetree
