// linetree cache sim: what eviction policies make of a recorded trace.
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/command.h"
#include "client/command/flags.h"
#include "client/command/output.h"
#include "client/command/policy_report.h"
#include "client/command/progress_bar.h"
#include "client/command/table.h"
#include "core/io/atomic_file.h"
#include "core/io/trace_file.h"
#include "core/policy/policies.h"

namespace linetree {
namespace {

struct CacheSimFlags {
  std::vector<std::string> traces;
  std::vector<std::string> policies;
  std::vector<PolicyBudget> budgets;
  bool ignores_size = false;
  std::string json, svg;
  bool quiet = false;
};

absl::Status Save(const CacheSimFlags& flags, const std::vector<PolicyRow>& rows) {
  if (!flags.json.empty()) {
    if (auto s = WriteJson(PolicyJson(rows), flags.json); !s.ok()) return s;
  }
  if (flags.svg.empty()) return absl::OkStatus();
  return WriteFileAtomically(flags.svg, SvgPlots(PolicyPlots(rows)));
}

absl::StatusOr<int> CacheSim(const CacheSimFlags& flags) {
  if (auto s = CheckFolders({flags.json, flags.svg}); !s.ok()) return s;
  ProgressBar bar(!flags.quiet && IsTerminal(), "cache sim");
  std::vector<PolicyRow> rows;
  for (size_t i = 0; i < flags.traces.size(); ++i) {
    const absl::StatusOr<Trace> trace = ReadTrace(flags.traces[i]);
    if (!trace.ok()) return trace.status();
    if (trace->empty()) {
      return absl::InvalidArgumentError(absl::StrCat(flags.traces[i], ": no records"));
    }
    const WorkingSet set = WorkingSetOf(*trace);
    std::cout << flags.traces[i] << ": " << Grouped(trace->size()) << " accesses in "
              << Grouped(set.frames) << " frames, " << Grouped(set.items) << " items, "
              << Bytes(set.bytes) << ", "
              << absl::StrFormat("%.3f ms to build each once\n", set.rebuild_ns / 1e6);
    auto more = SimulateAll(
        std::filesystem::path(flags.traces[i]).filename().string(), *trace, flags.policies,
        flags.budgets, flags.ignores_size, [&](double share) {
          bar.Show((static_cast<double>(i) + share) / static_cast<double>(flags.traces.size()));
        });
    if (!more.ok()) return more.status();
    rows.insert(rows.end(), more->begin(), more->end());
  }
  std::cout << PolicyTable(rows);
  if (auto s = Save(flags, rows); !s.ok()) return s;
  return kExitOk;
}

void AddSimFlags(CLI::App& app, CacheSimFlags& flags) {
  app.add_option("--trace", flags.traces, "Trace, oracleGeneral layout; may be given again")
      ->type_name("FILE")
      ->required();
  app.add_option_function<std::string>(
         "--policy",
         [&flags](const std::string& text) {
           const auto parsed = ParsePolicies(text);
           if (!parsed.ok()) {
             throw CLI::ValidationError("--policy", std::string(parsed.status().message()));
           }
           flags.policies = *parsed;
         },
         "Names with commas between them, belady among them, or all")
      ->type_name("NAME,…")
      ->default_str("all")
      ->run_callback_for_default()
      ->force_callback();
  app.add_option_function<std::vector<std::string>>(
         "--budget",
         [&flags](const std::vector<std::string>& texts) {
           flags.budgets.clear();
           for (const std::string& text : texts) {
             const auto parsed = ParseBudget(text);
             if (!parsed.ok()) {
               throw CLI::ValidationError("--budget", std::string(parsed.status().message()));
             }
             flags.budgets.push_back(*parsed);
           }
         },
         "Bytes (64m), or shares of the working set (25%), with commas between them")
      ->type_name("BYTES|SHARE%,…")
      ->delimiter(',')
      ->default_str("25%,50%,75%")
      ->force_callback();
  app.add_flag("--ignore-size", flags.ignores_size,
               "Count every item as one; budgets are numbers of items");
  AddJsonFlag(app, flags.json, "the figures");
  app.add_option("--svg", flags.svg, "Also plot hits and rebuild cost over the budget")
      ->type_name("FILE")
      ->check(HasExtension({".svg"}));
  AddQuietFlag(app, flags.quiet);
}

std::string PolicyHelp() {
  std::string help = "Policies:\n";
  for (const PolicyNote& note : AllPolicies()) {
    absl::StrAppend(
        &help, absl::StrFormat("  %-10s %s\n", std::string(note.name), std::string(note.what)));
  }
  absl::StrAppend(&help, "  belady     evicts what is used last from now on\n");
  return help;
}

}  // namespace

void AddCacheSim(CLI::App& cache, Commands& commands) {
  auto flags = std::make_shared<CacheSimFlags>();
  CLI::App* app = cache.add_subcommand("sim", "What eviction policies make of a recorded trace");
  AddSimFlags(*app, *flags);
  app->footer(absl::StrCat(
      "Replays a trace that linetreed --record-trace wrote, or any in the oracleGeneral layout, "
      "and "
      "prints hit ratios\nand what rebuilding the misses costs, also relative to a clairvoyant "
      "bound, below which no policy comes.\nCosts are read from FILE.cost, where there is one; "
      "else "
      "every miss costs 1 ns.\n\n",
      PolicyHelp(),
      "\nExamples:\n"
      "  linetree cache sim --trace room.trace\n"
      "  linetree cache sim --trace room.trace --policy lru,reuse,belady --budget 10%,25%,64m "
      "--svg "
      "room.svg\n"
      "  linetree cache sim --trace web.oracleGeneral --policy sieve,s3-fifo --budget 10000 "
      "--ignore-size --json web.json"));
  commands.push_back({app, [flags] { return CacheSim(*flags); }});
}

}  // namespace linetree
