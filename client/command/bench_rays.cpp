// linetree bench rays: batches of rays by packets and with the surface trees, against the scalar
// tracer.
#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/command.h"
#include "client/command/flags.h"
#include "client/command/output.h"
#include "client/command/progress_bar.h"
#include "client/command/table.h"
#include "core/audit/ray_speed.h"
#include "core/io/load_scene.h"

namespace linetree {
namespace {

struct BenchRaysFlags {
  std::vector<std::string> scenes;
  std::string scenes_dir = "scenes";
  SizeFlags size;
  RaySpeedOptions study;
  int threads = 1;
  std::string json;
  bool quiet = false;
};

constexpr std::array<std::string_view, 7> kScenes = {
    "room.textproto",  "face.textproto",  "glass.textproto", "many_lights.textproto",
    "spd/balls_4.nff", "spd/mount_4.nff", "spd/tree_8.nff"};

struct RaysRow {
  std::string scene;
  RaySpeeds speeds;

  uint64_t Beyond() const { return speeds.coherent.beyond + speeds.incoherent.beyond; }
};

void AddRow(Table& table, const std::string& scene, const std::string& rays,
            const RaySpeed& speed) {
  std::vector<std::string> cells = {scene, rays};
  for (const SpeedSpread& ns : speed.ns) cells.push_back(absl::StrFormat("%.1f", ns.median));
  cells.push_back(speed.binned ? "binned" : "as given");
  cells.push_back(absl::StrFormat("%.1f %%", 100 * speed.interpolated));
  cells.push_back(absl::StrFormat("%.1f %%", 100 * speed.replayed));
  cells.push_back(absl::StrFormat("%.1e", speed.largest_classical_error));
  cells.push_back(absl::StrFormat("%.2g", speed.largest_cached_error));
  cells.push_back(Grouped(speed.beyond));
  table.AddRow(std::move(cells));
}

std::string RaysTable(const std::vector<RaysRow>& rows) {
  std::vector<TableColumn> columns = {{"scene"}, {"rays"}};
  for (const std::string_view name : kRayWayNames) {
    columns.push_back({std::string(name), Align::kRight});
  }
  columns.push_back({"taken"});
  for (const char* name : {"interpolated", "replayed", "error of packets", "of cached", "beyond"}) {
    columns.push_back({name, Align::kRight});
  }
  Table table(std::move(columns));
  for (const RaysRow& row : rows) {
    AddRow(table, row.scene, "coherent", row.speeds.coherent);
    AddRow(table, row.scene, "incoherent", row.speeds.incoherent);
  }
  return table.ToString();
}

nlohmann::json SpeedJson(const RaySpeed& speed) {
  nlohmann::json json = {{"taken", speed.binned ? "binned" : "as given"},
                         {"interpolated", speed.interpolated},
                         {"replayed", speed.replayed},
                         {"rays", speed.rays},
                         {"beyond", speed.beyond},
                         {"largest_classical_error", speed.largest_classical_error},
                         {"largest_cached_error", speed.largest_cached_error},
                         {"lane_rounding", speed.lane_rounding}};
  for (size_t way = 0; way < kRayWayNames.size(); ++way) {
    const SpeedSpread& ns = speed.ns[way];
    json["ns_per_ray"][std::string(kRayWayNames[way])] = {
        {"median", ns.median}, {"least", ns.least}, {"most", ns.most}};
  }
  return json;
}

nlohmann::json RaysJson(const BenchRaysFlags& flags, const std::vector<RaysRow>& rows) {
  nlohmann::json json = {{"width", flags.study.width},
                         {"height", flags.study.height},
                         {"repeats", flags.study.repeats},
                         {"epsilon", flags.study.epsilon},
                         {"seed", flags.study.seed},
                         {"threads", flags.threads},
                         {"max_depth", flags.study.limits.max_depth},
                         {"min_weight", flags.study.limits.min_weight}};
  json["scenes"] = nlohmann::json::array();
  for (const RaysRow& row : rows) {
    json["scenes"].push_back({{"scene", row.scene},
                              {"coherent", SpeedJson(row.speeds.coherent)},
                              {"incoherent", SpeedJson(row.speeds.incoherent)}});
  }
  return json;
}

absl::StatusOr<std::vector<RaysRow>> Measure(const BenchRaysFlags& flags) {
  std::vector<std::string> files = flags.scenes;
  if (files.empty()) {
    for (const std::string_view name : kScenes) {
      files.push_back(flags.scenes_dir + "/" + std::string(name));
    }
  }
  std::vector<RaysRow> rows;
  WorkerPool pool(flags.threads);
  ProgressBar bar(!flags.quiet && IsTerminal(), "bench rays");
  for (const std::string& file : files) {
    auto scene = LoadSceneFile(file);
    if (!scene.ok()) return scene.status();
    if ((*scene)->cameras.empty()) {
      return absl::InvalidArgumentError(absl::StrCat(file, ": expected a camera"));
    }
    auto speeds = StudyRaySpeed(*scene, (*scene)->cameras[0], flags.study, pool);
    if (!speeds.ok()) return speeds.status();
    rows.push_back({std::filesystem::path(file).stem(), *std::move(speeds)});
    bar.Show(static_cast<double>(rows.size()) / static_cast<double>(files.size()));
  }
  return rows;
}

absl::StatusOr<int> BenchRays(BenchRaysFlags& flags) {
  if (!flags.json.empty()) {
    if (absl::Status status = CheckFolders({flags.json}); !status.ok()) return status;
  }
  flags.study.width = flags.size.width;
  flags.study.height = flags.size.height;
  const auto rows = Measure(flags);
  if (!rows.ok()) return rows.status();
  std::cout << "Batches of " << flags.study.width << " x " << flags.study.height
            << " rays, ns per ray, " << flags.threads << " thread(s), median of "
            << flags.study.repeats << ", epsilon " << flags.study.epsilon << "\n"
            << RaysTable(*rows);
  if (!flags.json.empty()) {
    if (auto s = WriteJson(RaysJson(flags, *rows), flags.json); !s.ok()) return s;
  }
  const bool holds =
      std::all_of(rows->begin(), rows->end(), [](auto& row) { return row.Beyond() == 0; });
  return holds ? kExitOk : kExitFailure;
}

}  // namespace

void AddBenchRays(CLI::App& bench, Commands& commands) {
  auto flags = std::make_shared<BenchRaysFlags>();
  CLI::App* app = bench.add_subcommand(
      "rays", "Batches of coherent and of incoherent rays: scalar, by packets, cached");
  app->add_option("--scene", flags->scenes, "Scene file; may be given again")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->default_str("a choice of the folder's");
  app->add_option("--scenes", flags->scenes_dir, "Folder of the scenes")
      ->type_name("DIR")
      ->capture_default_str();
  AddSizeFlags(*app, flags->size);
  app->add_option("--epsilon", flags->study.epsilon, "What cached answers promise")
      ->type_name("E")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app->add_option("--seed", flags->study.seed, "Of the incoherent rays")
      ->type_name("N")
      ->capture_default_str();
  app->add_option("--threads", flags->threads, "Threads that answer")
      ->type_name("N")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  AddLimitsFlags(*app, flags->study.limits);
  app->add_option("--repeat", flags->study.repeats, "Batches of each kind; the median counts")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  AddJsonFlag(*app, flags->json, "the table");
  AddQuietFlag(*app, flags->quiet);
  app->footer(
      "Coherent: the eye rays of a picture of that size, row by row. Incoherent: as many rays from "
      "anywhere in the\nscene's bounds in any direction, new ones for every batch. All ways of "
      "answering take turns in one process;\ncaches are warm. \"Taken\" is the order that --lanes "
      "simd takes. Ends with status 1 when an answer by\npackets is beyond what it promises "
      "against "
      "the scalar classical tracer.\n\nExamples:\n  "
      "linetree bench rays --json rays.json\n  "
      "linetree bench rays --scene scenes/room.textproto --width 256 --height 256 --repeat 9");
  commands.push_back({app, [flags] { return BenchRays(*flags); }});
}

}  // namespace linetree
