// linetree bench budget: a cache that is far too small, against none.
#include <iostream>
#include <memory>

#include "client/command/budget_run.h"
#include "client/command/command.h"
#include "client/command/flags.h"
#include "client/command/output.h"
#include "client/command/policy_flags.h"
#include "client/command/progress_bar.h"
#include "client/command/table.h"

namespace linetree {
namespace {

struct BenchBudgetFlags {
  BudgetPlan plan{.corpus = {.scenes = CorpusScenes("scenes"),
                             .patterns = AllFlightPatterns(),
                             .frames = 40,
                             .size = {256, 256},
                             .threads = 1}};
  std::string json;
  bool quiet = false;
};

absl::StatusOr<int> BenchBudget(const BenchBudgetFlags& flags) {
  if (auto s = CheckFolders({flags.json}); !s.ok()) return s;
  absl::StatusOr<nlohmann::json> rows;
  {
    ProgressBar bar(!flags.quiet && IsTerminal(), "bench budget");
    rows = RunBudgets(flags.plan, [&bar](double share) { bar.Show(share); });
  }
  if (!rows.ok()) return rows.status();
  const ReportTable report = BudgetTable(*rows);
  std::cout << "Time of cached frames by classical ones:\n"
            << TextTable(report.titles, report.rows, 3);
  if (!flags.json.empty()) {
    if (auto s = WriteJson(*rows, flags.json); !s.ok()) return s;
  }
  bool all_met = true;
  for (const ReportGoal& goal : BudgetGoals(*rows)) {
    std::cout << goal.what << ": " << goal.wanted << "; " << goal.got << "\n";
    all_met = all_met && goal.met;
  }
  return all_met ? kExitOk : kExitMissed;
}

void AddBudgetFlags(CLI::App& app, BenchBudgetFlags& flags) {
  AddCorpusFlags(app, flags.plan.corpus);
  app.add_option("--lanes", flags.plan.lanes, "Ray by ray or by packets; both by default")
      ->type_name("LANES")
      ->transform(CLI::CheckedTransformer(LanesByName(), CLI::ignore_case))
      ->default_str("");
  app.add_option("--share", flags.plan.share, "Of the working set that the cache may hold")
      ->type_name("S")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--repeat", flags.plan.repeats, "Flights, of which each frame's median counts")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  AddJsonFlag(app, flags.json, "the figures");
  AddQuietFlag(app, flags.quiet);
}

}  // namespace

void AddBenchBudget(CLI::App& bench, Commands& commands) {
  auto flags = std::make_shared<BenchBudgetFlags>();
  CLI::App* app = bench.add_subcommand("budget", "A cache that is far too small, against none");
  AddBudgetFlags(*app, *flags);
  app->footer(
      "Flies once with a large cache, whose bytes at the end are the working set, then with one "
      "of a small share of it:\nits frames and classical ones in turn. Exit status 3 when a flight "
      "takes more than 5 % longer with the cache.\n\nExamples:\n"
      "  linetree bench budget\n"
      "  linetree bench budget --scene scenes/room.textproto --flight orbit --lanes scalar "
      "--share 0.2");
  commands.push_back({app, [flags] { return BenchBudget(*flags); }});
}

}  // namespace linetree
