// linetree bench lookups: warm trees and many readers.
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "absl/strings/str_format.h"
#include "client/command/command.h"
#include "client/command/flags.h"
#include "client/command/output.h"
#include "client/command/progress_bar.h"
#include "client/command/table.h"
#include "core/audit/lookup_study.h"
#include "core/io/load_scene.h"

namespace linetree {
namespace {

struct BenchLookupsFlags {
  std::string scene = "scenes/room.textproto";
  SizeFlags size;
  LookupStudyOptions study;
  std::string json;
  bool quiet = false;
};

const char* NameOf(EpochKind kind) {
  return kind == EpochKind::kRcu ? "without locks" : "shared lock";
}

// By one thread, or by as few as were measured.
double ScalingOf(const LookupStudy& study, const LookupRow& row) {
  for (const LookupRow& first : study.rows) {
    if (first.kind == row.kind) return row.per_second.median / first.per_second.median;
  }
  return 1;
}

std::string LookupText(const LookupStudy& study) {
  Table table({{"threads", Align::kRight},
               {"readers"},
               {"lookups/s", Align::kRight},
               {"least", Align::kRight},
               {"most", Align::kRight},
               {"by the first", Align::kRight}});
  for (const LookupRow& row : study.rows) {
    const auto millions = [](double n) { return absl::StrFormat("%.2f M", n / 1e6); };
    table.AddRow({absl::StrFormat("%d", row.threads), NameOf(row.kind),
                  millions(row.per_second.median), millions(row.per_second.least),
                  millions(row.per_second.most), absl::StrFormat("%.2f", ScalingOf(study, row))});
  }
  return absl::StrFormat("%s rays, of which trees know %s; %s cells\n%s", Grouped(study.rays),
                         Grouped(study.known), Grouped(study.cells), table.ToString());
}

nlohmann::json LookupJson(const LookupStudy& study, const BenchLookupsFlags& flags) {
  nlohmann::json rows = nlohmann::json::array();
  for (const LookupRow& row : study.rows) {
    rows.push_back({{"threads", row.threads},
                    {"readers", NameOf(row.kind)},
                    {"per_second", row.per_second.median},
                    {"least", row.per_second.least},
                    {"most", row.per_second.most},
                    {"scaling", ScalingOf(study, row)}});
  }
  return {{"scene", flags.scene},
          {"rays", study.rays},
          {"known", study.known},
          {"cells", study.cells},
          {"rows", std::move(rows)}};
}

absl::StatusOr<int> BenchLookups(BenchLookupsFlags& flags) {
  if (auto s = CheckFolders({flags.json}); !s.ok()) return s;
  flags.study.width = flags.size.width;
  flags.study.height = flags.size.height;
  const auto scene = LoadSceneFile(flags.scene);
  if (!scene.ok()) return scene.status();
  WorkerPool pool(0);
  absl::StatusOr<LookupStudy> study;
  {
    ProgressBar bar(!flags.quiet && IsTerminal(), "bench lookups");
    study = StudyLookups(*scene, flags.study, pool, [&bar](double share) { bar.Show(share); });
  }
  if (!study.ok()) return study.status();
  std::cout << LookupText(*study);
  if (!flags.json.empty()) {
    if (auto s = WriteJson(LookupJson(*study, flags), flags.json); !s.ok()) return s;
  }
  return kExitOk;
}

void AddLookupsFlags(CLI::App& app, BenchLookupsFlags& flags) {
  app.add_option("--scene", flags.scene, "Scene file with a camera")
      ->type_name("FILE")
      ->capture_default_str();
  AddSizeFlags(app, flags.size);
  app.add_option("--threads", flags.study.threads, "Numbers of threads, with commas between them")
      ->type_name("N,...")
      ->delimiter(',')
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option("--passes", flags.study.passes, "Of each thread over the eye rays of a frame")
      ->type_name("N")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  app.add_option("--repeat", flags.study.repeat, "Of which the median is shown")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--epsilon", flags.study.epsilon, "What cached answers promise")
      ->type_name("E")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  AddJsonFlag(app, flags.json, "the figures");
  AddQuietFlag(app, flags.quiet);
}

}  // namespace

void AddBenchLookups(CLI::App& bench, Commands& commands) {
  auto flags = std::make_shared<BenchLookupsFlags>();
  CLI::App* app = bench.add_subcommand("lookups", "Lookups in warm trees by several threads");
  AddLookupsFlags(*app, *flags);
  app->footer(
      "Warms the trees of a scene with frames, then looks up the hits of the same view in surface "
      "trees and linetrees,\nby one thread and by several at the same time: without locks, as "
      "always, and with a lock that readers share.\n\nExamples:\n"
      "  linetree bench lookups\n"
      "  linetree bench lookups --scene scenes/glass.textproto --threads 1,2,4,8 --json "
      "lookups.json");
  commands.push_back({app, [flags] { return BenchLookups(*flags); }});
}

}  // namespace linetree
