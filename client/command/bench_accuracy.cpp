// linetree bench accuracy: every pixel of cached frames against classical ones, cold and warm.
#include <iostream>
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/command.h"
#include "client/command/error_sweep.h"
#include "client/command/flags.h"
#include "client/command/output.h"
#include "client/command/progress_bar.h"
#include "client/command/table.h"

namespace linetree {
namespace {

struct BenchAccuracyFlags {
  ConnectionFlags connection{.local = true};
  std::vector<std::string> scenes = {"scenes/face.textproto",  "scenes/room.textproto",
                                     "scenes/glass.textproto", "scenes/spd/balls_3.nff",
                                     "scenes/spd/mount_4.nff", "scenes/spd/tree_8.nff",
                                     "scenes/spd/rings_1.nff", "scenes/spd/lattice_2.nff"};
  SizeFlags size;
  std::vector<double> epsilons = {0.5, 0.25, 0.1, 0.05};
  JudgeKind judge = JudgeKind::kCertified;
  std::string json;
  bool quiet = false;
};

struct SceneRows {
  std::string scene;
  std::vector<ErrorSweepRow> rows;
};

absl::StatusOr<SceneRows> Measure(Client& client, const std::string& path,
                                  const BenchAccuracyFlags& flags,
                                  const std::function<void(double)>& progress) {
  const absl::StatusOr<SceneFile> file = ReadSceneFileChecked(path);
  if (!file.ok()) return file.status();
  const Camera* camera = file->scene->FindCamera("");
  if (camera == nullptr) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": expected a scene with a camera"));
  }
  ErrorSweepOptions options;
  options.request.camera = *camera;
  options.request.width = flags.size.width;
  options.request.height = flags.size.height;
  options.request.options.judge = flags.judge;
  options.epsilons = flags.epsilons;
  options.repeats = 1;
  auto rows = SweepErrors(client, *file, absl::StrCat("accuracy-", file->name), options, progress);
  if (!rows.ok()) return rows.status();
  return SceneRows{file->name, *std::move(rows)};
}

nlohmann::json FiguresJson(const ErrorFigures& figures, double success, double epsilon) {
  return {{"success", success},
          {"beyond_epsilon", figures.beyond},
          {"max_relative_error", figures.max},
          {"max_error_over_epsilon", epsilon > 0 ? figures.max / epsilon : 0}};
}

// One line a scene and epsilon, its cold and warm frame side by side.
int Print(const std::vector<SceneRows>& all, nlohmann::json& json) {
  Table table({{"scene", Align::kLeft},
               {"epsilon", Align::kRight},
               {"pixels", Align::kRight},
               {"cold success", Align::kRight},
               {"beyond", Align::kRight},
               {"max error", Align::kRight},
               {"warm success", Align::kRight},
               {"beyond", Align::kRight},
               {"max error", Align::kRight}});
  uint64_t beyond = 0, pixels = 0;
  for (const SceneRows& scene : all) {
    for (const ErrorSweepRow& row : scene.rows) {
      table.AddRow({scene.scene, absl::StrFormat("%.2f", row.epsilon), Grouped(row.cold.pixels),
                    Percent(row.cold_success), Grouped(row.cold.beyond),
                    absl::StrFormat("%.3g", row.cold.max), Percent(row.warm_success),
                    Grouped(row.warm.beyond), absl::StrFormat("%.3g", row.warm.max)});
      json.push_back({{"scene", scene.scene},
                      {"epsilon", row.epsilon},
                      {"pixels", row.cold.pixels},
                      {"cold", FiguresJson(row.cold, row.cold_success, row.epsilon)},
                      {"warm", FiguresJson(row.warm, row.warm_success, row.epsilon)}});
      beyond += row.cold.beyond + row.warm.beyond;
      pixels += row.cold.pixels + row.warm.pixels;
    }
  }
  std::cout << table.ToString() << "\n"
            << Grouped(beyond) << " of " << Grouped(pixels)
            << " pixels beyond epsilon. The paper's judge is a heuristic and may have a few, the "
               "certified one none.\n";
  return kExitOk;
}

absl::StatusOr<int> BenchAccuracy(const BenchAccuracyFlags& flags) {
  if (!flags.json.empty()) {
    if (absl::Status status = CheckFolders({flags.json}); !status.ok()) return status;
  }
  const absl::StatusOr<std::unique_ptr<Client>> client = Connect(flags.connection);
  if (!client.ok()) return client.status();
  ProgressBar bar(!flags.quiet && IsTerminal(), "bench accuracy");
  std::vector<SceneRows> all;
  for (const std::string& path : flags.scenes) {
    auto rows = Measure(**client, path, flags, [&](double share) {
      bar.Show((static_cast<double>(all.size()) + share) /
               static_cast<double>(flags.scenes.size()));
    });
    if (!rows.ok()) return rows.status();
    all.push_back(*std::move(rows));
  }
  nlohmann::json json = nlohmann::json::array();
  const int exit_status = Print(all, json);
  if (!flags.json.empty()) {
    if (absl::Status status = WriteJson(json, flags.json); !status.ok()) return status;
  }
  return exit_status;
}

}  // namespace

void AddBenchAccuracy(CLI::App& bench, Commands& commands) {
  auto flags = std::make_shared<BenchAccuracyFlags>();
  CLI::App* app = bench.add_subcommand(
      "accuracy", "Every pixel of cached frames against classical ones, cold and warm");
  app->add_option("--scene", flags->scenes, "Scene file; may be given again")
      ->type_name("FILE")
      ->capture_default_str();
  app->add_option("--epsilons", flags->epsilons, "Promised relative errors, in [0, 1]")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  AddJudgeFlag(*app, flags->judge);
  AddSizeFlags(*app, flags->size);
  AddThreadsFlag(*app, flags->connection.threads);
  AddJsonFlag(*app, flags->json, "the table");
  AddQuietFlag(*app, flags->quiet);
  app->footer("Run it from the project's folder, where scenes/ is.");
  commands.push_back({app, [flags] { return BenchAccuracy(*flags); }});
}

}  // namespace linetree
