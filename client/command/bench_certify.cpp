// linetree bench certify: what the certified judge accepts, what that costs, and that it holds.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "absl/strings/str_cat.h"
#include "client/command/certify_report.h"
#include "client/command/command.h"
#include "client/command/flags.h"
#include "client/command/output.h"
#include "client/command/progress_bar.h"
#include "client/command/scene_files.h"
#include "client/command/table.h"
#include "core/io/load_scene.h"

namespace linetree {
namespace {

constexpr std::array<std::string_view, 3> kParts = {"cells", "lights", "frames"};
// Lights of the second table, beside the scene's own.
constexpr std::array<size_t, 4> kLightCounts = {3, 16, 32, 128};

struct BenchCertifyFlags {
  CellStudyOptions cells;
  std::vector<std::string> families = {kSparseFamilyNames.begin(), kSparseFamilyNames.end()};
  FrameStudyOptions frames;
  std::vector<std::string> parts = {kParts.begin(), kParts.end()};
  std::vector<std::string> scenes;
  std::string scenes_dir = "scenes";
  double min_footprint = 200;
  int threads = 0;
  std::string json;
  bool quiet = false;

  bool Wants(std::string_view part) const {
    return std::find(parts.begin(), parts.end(), part) != parts.end();
  }
};

std::vector<SparseFamily> FamiliesOf(const std::vector<std::string>& names) {
  std::vector<SparseFamily> families;
  for (const std::string& name : names) {
    const auto at = std::find(kSparseFamilyNames.begin(), kSparseFamilyNames.end(), name);
    families.push_back(static_cast<SparseFamily>(at - kSparseFamilyNames.begin()));
  }
  return families;
}

absl::Status MeasureLights(const BenchCertifyFlags& flags, WorkerPool& pool,
                           CertifyReport& report) {
  report.lights_scene = flags.scenes_dir + "/room.textproto";
  const auto scene = LoadSceneFile(report.lights_scene);
  if (!scene.ok()) return scene.status();
  for (const size_t count : kLightCounts) {
    const auto lit = WithLights(**scene, count);
    for (const bool functions : {false, true}) {
      report.lights.push_back(StudyLights(*lit, lit->cameras.at(0), flags.frames.side,
                                          flags.min_footprint, functions, pool));
    }
  }
  return absl::OkStatus();
}

absl::Status MeasureFrames(const BenchCertifyFlags& flags, const std::vector<std::string>& files,
                           WorkerPool& pool, CertifyReport& report,
                           const std::function<void(double)>& progress) {
  for (size_t i = 0; i < files.size(); ++i) {
    const auto scene = LoadSceneFile(files[i]);
    if (!scene.ok()) return scene.status();
    if ((*scene)->cameras.empty()) {
      return absl::InvalidArgumentError(absl::StrCat(files[i], ": expected a camera"));
    }
    const auto rows = StudyFrames(
        *scene, OrbitOf((*scene)->cameras[0], flags.frames.frames), flags.frames, pool,
        [&](double share) {
          progress((static_cast<double>(i) + share) / static_cast<double>(files.size()));
        });
    if (!rows.ok()) return rows.status();
    report.frames.push_back({std::filesystem::path(files[i]).stem(), *rows});
  }
  return absl::OkStatus();
}

absl::StatusOr<CertifyReport> Measure(const BenchCertifyFlags& flags) {
  // What is missing is better known before the work than after it.
  std::vector<std::string> files = flags.scenes;
  if (files.empty() && flags.Wants("frames")) {
    auto found = ScenesIn(flags.scenes_dir);
    if (!found.ok()) return found.status();
    files = *std::move(found);
  }
  WorkerPool pool(flags.threads);
  CertifyReport report;
  report.cell_options = flags.cells;
  report.cell_options.families = FamiliesOf(flags.families);
  const bool shows = !flags.quiet && IsTerminal();
  if (flags.Wants("cells")) {
    ProgressBar bar(shows, "bench certify: cells");
    report.cells = StudyCells(report.cell_options, pool, [&](double share) { bar.Show(share); });
  }
  if (flags.Wants("lights")) {
    if (auto s = MeasureLights(flags, pool, report); !s.ok()) return s;
  }
  if (flags.Wants("frames")) {
    ProgressBar bar(shows, "bench certify: frames");
    auto s = MeasureFrames(flags, files, pool, report, [&](double share) { bar.Show(share); });
    if (!s.ok()) return s;
  }
  return report;
}

void Print(const BenchCertifyFlags& flags, const CertifyReport& report) {
  if (!report.cells.empty()) {
    std::cout << "Random 4D cells, edges relative to the object's bounding box (seed "
              << flags.cells.seed << ")\n"
              << CellTable(report)
              << "\nWhy cells are refused, as shares of all of them: the first "
              << "doubt about their paths (in brackets: of cells whose sampled rays all take the "
                 "same path), or too large a bound\n"
              << DoubtTable(report) << "\n";
  }
  if (!report.lights.empty()) {
    std::cout << "Lights over " << report.lights_scene << ", " << flags.frames.side << " x "
              << flags.frames.side << ", cells of at least " << flags.min_footprint << " pixels\n"
              << LightTable(report) << "\n";
  }
  if (!report.frames.empty()) {
    std::cout << flags.frames.frames
              << " frames each on an orbit, and the first again; searches of the scene relative to "
                 "classical\n"
              << FrameTable(report) << "\n";
  }
  std::cout << Grouped(report.Violations()) << " violations\n";
}

absl::StatusOr<int> BenchCertify(const BenchCertifyFlags& flags) {
  if (!flags.json.empty()) {
    if (absl::Status status = CheckFolders({flags.json}); !status.ok()) return status;
  }
  const auto report = Measure(flags);
  if (!report.ok()) return report.status();
  Print(flags, *report);
  if (!flags.json.empty()) {
    if (auto s = WriteJson(CertifyJson(*report), flags.json); !s.ok()) return s;
  }
  return report->Violations() > 0 ? kExitFailure : kExitOk;
}

}  // namespace

void AddBenchCertify(CLI::App& bench, Commands& commands) {
  auto flags = std::make_shared<BenchCertifyFlags>();
  CLI::App* app = bench.add_subcommand(
      "certify", "What the certified judge accepts, what that costs, and that it holds");
  app->add_option("--part", flags->parts, "Only these tables")
      ->type_name("NAME")
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>(kParts.begin(), kParts.end())))
      ->capture_default_str();
  app->add_option("--seed", flags->cells.seed, "Of the random cells")->capture_default_str();
  app->add_option("--family", flags->families, "Of the random scenes with cells")
      ->type_name("NAME")
      ->delimiter(',')
      ->check(CLI::IsMember(
          std::vector<std::string>(kSparseFamilyNames.begin(), kSparseFamilyNames.end())))
      ->capture_default_str();
  app->add_option("--cell-scenes", flags->cells.scenes,
                  "Random scenes of each family, 60 cells each and edge")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  app->add_option("--scene", flags->scenes, "Scene file for the frames; may be given again")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->default_str("all of the folder");
  app->add_option("--scenes", flags->scenes_dir, "Folder of the scenes")
      ->type_name("DIR")
      ->capture_default_str();
  app->add_option("--frames", flags->frames.frames, "Frames of each scene's orbit, 1 degree apart")
      ->check(CLI::Range(1, 360))
      ->capture_default_str();
  app->add_option("--size", flags->frames.side, "Pixels of a frame's side")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  app->add_option("--epsilons", flags->frames.epsilons, "Promised relative errors, in [0, 1]")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app->add_option("--footprint", flags->min_footprint,
                  "Surface cells of fewer pixels are not divided")
      ->check(CLI::Range(1.0, 1e6))
      ->capture_default_str();
  AddThreadsFlag(*app, flags->threads);
  AddJsonFlag(*app, flags->json, "the tables");
  AddQuietFlag(*app, flags->quiet);
  app->footer(
      "Run it from the project's folder, where scenes/ is. Ends with status 1 when a promise was "
      "broken.\n\nExamples:\n  linetree bench certify --json certify.json\n  linetree bench "
      "certify --part frames --scene scenes/glass.textproto --frames 5");
  commands.push_back({app, [flags] { return BenchCertify(*flags); }});
}

}  // namespace linetree
