// linetree bench error: what an epsilon costs and gives, from 0 to 1.
#include <unistd.h>

#include <iostream>
#include <memory>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/command/command.h"
#include "client/command/error_sweep.h"
#include "client/command/flags.h"
#include "client/command/output.h"
#include "client/command/parse_values.h"
#include "client/command/progress_bar.h"
#include "core/io/atomic_file.h"
#include "core/io/wire.h"

namespace linetree {
namespace {

struct BenchErrorFlags {
  ConnectionFlags connection;
  SceneFlags scene{.scene = "scenes/room.textproto"};
  ViewFlags view;
  SizeFlags size;
  JudgeKind judge = JudgeKind::kCertified;
  PathLimits limits;
  std::vector<double> epsilons = {0, 0.01, 0.02, 0.05, 0.1, 0.15, 0.25, 0.35, 0.5, 0.75, 1};
  int repeats = 3;
  std::vector<std::string> outputs;
  bool quiet = false;
};

absl::StatusOr<std::vector<ErrorSweepRow>> SweepScene(const BenchErrorFlags& flags) {
  const absl::StatusOr<SceneFile> file = ReadSceneFileChecked(flags.scene.scene);
  if (!file.ok()) return file.status();
  const absl::StatusOr<Camera> camera =
      ResolveCamera(SceneInfoToWire(file->name, *file->scene, 0), flags.view);
  if (!camera.ok()) return camera.status();
  const absl::StatusOr<std::unique_ptr<Client>> client = Connect(flags.connection);
  if (!client.ok()) return client.status();
  ErrorSweepOptions options;
  options.request.camera = *camera;
  options.request.width = flags.size.width;
  options.request.height = flags.size.height;
  options.request.options.judge = flags.judge;
  options.request.options.limits = flags.limits;
  options.epsilons = flags.epsilons;
  options.repeats = flags.repeats;
  ProgressBar bar(!flags.quiet && IsTerminal(), "bench error");
  // A name of its own: what others have on the server stays warm.
  return SweepErrors(**client, *file, absl::StrCat("bench-", getpid(), "-", file->name), options,
                     [&bar](double share) { bar.Show(share); });
}

absl::StatusOr<int> BenchError(const BenchErrorFlags& flags) {
  if (absl::Status status = CheckFolders(flags.outputs); !status.ok()) return status;
  const absl::StatusOr<std::vector<ErrorSweepRow>> rows = SweepScene(flags);
  if (!rows.ok()) return rows.status();
  const std::string csv = ErrorSweepCsv(*rows);
  bool csv_written = false;
  for (const std::string& output : flags.outputs) {
    const bool is_csv = absl::EndsWithIgnoreCase(output, ".csv");
    csv_written = csv_written || is_csv;
    absl::Status status = WriteFileAtomically(
        output, is_csv ? csv : SvgPlots(ErrorSweepPlots(*rows, flags.scene.scene)));
    if (!status.ok()) return status;
  }
  if (!csv_written) std::cout << csv;
  return kExitOk;
}

void AddEpsilons(CLI::App& app, std::vector<double>& epsilons) {
  app.add_option_function<std::string>(
         "--epsilons",
         [&epsilons](const std::string& text) {
           const absl::StatusOr<std::vector<double>> parsed = ParseNumbers(text);
           if (!parsed.ok()) {
             throw CLI::ValidationError("--epsilons", std::string(parsed.status().message()));
           }
           for (const double epsilon : *parsed) {
             if (epsilon >= 0 && epsilon <= 1) continue;
             throw CLI::ValidationError("--epsilons", "expected numbers in [0, 1]");
           }
           epsilons = *parsed;
         },
         "Promised relative errors to try, in [0, 1]")
      ->type_name("E,E,…")
      ->default_str("0,0.01,0.02,0.05,0.1,0.15,0.25,0.35,0.5,0.75,1");
}

}  // namespace

void AddBenchError(CLI::App& bench, Commands& commands) {
  auto flags = std::make_shared<BenchErrorFlags>();
  CLI::App* app = bench.add_subcommand("error", "Run time, success and error over epsilon");
  AddConnectionFlags(*app, flags->connection);
  app->add_option("--scene", flags->scene.scene, "Scene file")
      ->type_name("FILE")
      ->capture_default_str()
      ->group("Scene");
  AddViewFlags(*app, flags->view);
  AddSizeFlags(*app, flags->size);
  AddJudgeFlag(*app, flags->judge);
  AddLimitsFlags(*app, flags->limits);
  AddEpsilons(*app, flags->epsilons);
  app->add_option("--repeat", flags->repeats, "Measurements of which the median counts")
      ->type_name("N")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("-o,--output", flags->outputs, "Table, .csv, or plot, .svg; may be given again")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->check(HasExtension({".csv", ".svg"}))
      ->group("Output");
  AddQuietFlag(*app, flags->quiet);
  app->footer(
      "For every epsilon: a cold frame (empty cache), a warm one, and a classical one to measure "
      "both "
      "against.\nThe table goes to standard output unless a .csv is given.\n\n"
      "Examples:\n"
      "  linetree bench error --local --scene scenes/room.textproto -o room.csv -o room.svg\n"
      "  linetree bench error --local --scene scenes/face.textproto --epsilons 0,0.25 --width 128 "
      "--height 128");
  commands.push_back({app, [flags] { return BenchError(*flags); }});
}

}  // namespace linetree
