// linetree bench audit: answers of the cache against the classical tracer, in random scenes.
#include <iostream>
#include <map>
#include <memory>

#include "client/command/audit_report.h"
#include "client/command/command.h"
#include "client/command/flags.h"
#include "client/command/output.h"
#include "client/command/progress_bar.h"
#include "core/audit/audit.h"
#include "core/io/load_scene.h"

namespace linetree {
namespace {

struct BenchAuditFlags {
  AuditOptions options;
  std::vector<std::string> scenes;
  std::vector<std::string> families;
  int threads = 0;
  std::string json;
  bool quiet = false;
};

std::vector<std::string> FamilyNames() {
  return {kSceneFamilyNames.begin(), kSceneFamilyNames.end()};
}

// The families that were named; all of them when neither families nor files were.
absl::StatusOr<AuditOptions> OptionsOf(const BenchAuditFlags& flags) {
  AuditOptions options = flags.options;
  const bool all = flags.families.empty() && flags.scenes.empty();
  for (const std::string& name : all ? FamilyNames() : flags.families) {
    options.families.push_back(*FamilyOfName(name));
  }
  for (const std::string& path : flags.scenes) {
    auto scene = LoadSceneFile(path);
    if (!scene.ok()) return scene.status();
    options.files.push_back({path, *std::move(scene)});
  }
  return options;
}

absl::StatusOr<int> BenchAudit(const BenchAuditFlags& flags) {
  if (!flags.json.empty()) {
    if (absl::Status status = CheckFolders({flags.json}); !status.ok()) return status;
  }
  const auto options = OptionsOf(flags);
  if (!options.ok()) return options.status();
  WorkerPool pool(flags.threads);
  Answerer answerer;
  absl::StatusOr<AuditReport> report;
  {
    ProgressBar bar(!flags.quiet && IsTerminal(), "bench audit");
    report = RunAudit(*options, answerer, pool, [&bar](double share) { bar.Show(share); });
  }
  if (!report.ok()) return report.status();
  std::cout << AuditText(*report);
  if (!flags.json.empty()) {
    absl::Status status = WriteJson(AuditJson(*report, *options), flags.json);
    if (!status.ok()) return status;
  }
  return report->total.violations > 0 ? kExitFailure : kExitOk;
}

void AddAuditFlags(CLI::App& app, BenchAuditFlags& flags) {
  app.add_option("--queries", flags.options.queries, "Ask at least about so many, in all")
      ->type_name("N")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", flags.options.seed, "Of scenes and queries")
      ->type_name("S")
      ->capture_default_str();
  app.add_option("--family", flags.families, "Random scenes of this family; may be given again")
      ->type_name("NAME")
      ->allow_extra_args(false)
      ->check(CLI::IsMember(FamilyNames()))
      ->default_str("all, unless --scene is given");
  app.add_option("--scene", flags.scenes, "Scene file with a camera; may be given again")
      ->type_name("FILE")
      ->allow_extra_args(false);
  app.add_option("--epsilon", flags.options.epsilons, "Promised relative errors, in [0, 1]")
      ->type_name("E")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  const std::map<std::string, JudgeKind> judges = {{"paper", JudgeKind::kPaper},
                                                   {"certified", JudgeKind::kCertified}};
  app.add_option("--judge", flags.options.judge, "Whose answers: paper or certified")
      ->transform(CLI::CheckedTransformer(judges))
      ->type_name("JUDGE")
      ->default_str("certified");
  AddThreadsFlag(app, flags.threads);
  AddJsonFlag(app, flags.json, "the report");
  AddQuietFlag(app, flags.quiet);
}

}  // namespace

void AddBenchAudit(CLI::App& bench, Commands& commands) {
  auto flags = std::make_shared<BenchAuditFlags>();
  CLI::App* app = bench.add_subcommand(
      "audit", "Every answer of the cache against the classical tracer, in random scenes");
  AddAuditFlags(*app, *flags);
  app->footer(
      "Warms the cache of each scene with small frames, then asks for rays at random, at corners "
      "and\nedges, and uphill towards larger errors. An answer violates the promise when a channel "
      "is off by\nmore than epsilon * max(classical, white/1024); at epsilon 0, by a bit. Ends "
      "with "
      "status 1 when\none did, and prints what is needed to ask again; at most 20 of them.\n\n"
      "Examples:\n"
      "  linetree bench audit --queries 10000000 --seed 7 --json audit.json\n"
      "  linetree bench audit --family mirrors --family walls --epsilon 0.02,0.1\n"
      "  linetree bench audit --scene scenes/room.textproto --judge paper");
  commands.push_back({app, [flags] { return BenchAudit(*flags); }});
}

}  // namespace linetree
