// Section: what many clients on overlapping paths build together, and how fast they are served.
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/load_goals.h"
#include "client/command/load_run.h"
#include "client/command/local_client.h"
#include "client/command/report_flight.h"
#include "client/command/report_sections.h"
#include "client/command/scene_files.h"
#include "client/command/table.h"

namespace linetree {
namespace {

using Json = nlohmann::json;

constexpr double kOverlap = 0.5;
// Cells that 16 clients may build, by those that one builds which flies the union of their paths.
constexpr double kMostCells = 1.3;
constexpr size_t kGoalClients = 16;
constexpr const char* kScene = "room.textproto";
constexpr const char* kPath = "paths/room_walk.textproto";

struct SharingSetting {
  std::string scene_file, path_file;
  int side = 256;
  int path_frames = 0;
  std::vector<size_t> clients;
  int threads = 0;
};

// All clients at the same time, on a cache that starts empty.
absl::StatusOr<LoadFigures> FlyTogether(const SharingSetting& setting, const SceneFile& file,
                                        const std::vector<Camera>& cameras, size_t clients,
                                        const Progress& progress) {
  LocalClient client(setting.threads, CacheOptions{}.memory_bytes);
  if (auto info = SendScene(client, file, file.name, false); !info.ok()) return info.status();
  LoadPlan plan{.scene = file.name};
  plan.frame.width = plan.frame.height = setting.side;
  plan.paths = {cameras};
  plan.pieces = PlanPieces(clients, {cameras.size()}, kOverlap);
  const auto phases = RunLoad(plan, std::vector<Client*>(clients, &client), progress);
  if (!phases.ok()) return phases.status();
  return SummarizeLoad(phases->back());
}

// The cells that one client builds which flies the pieces of all one after the other.
absl::StatusOr<uint64_t> BuildInTurn(const SharingSetting& setting, const SceneFile& file,
                                     const std::vector<Camera>& cameras, size_t clients) {
  LocalClient client(setting.threads, CacheOptions{}.memory_bytes);
  if (auto info = SendScene(client, file, file.name, false); !info.ok()) return info.status();
  LoadPlan plan{.scene = file.name};
  plan.frame.width = plan.frame.height = setting.side;
  plan.paths = {cameras};
  uint64_t cells = 0;
  for (const FlightPiece& piece : PlanPieces(clients, {cameras.size()}, kOverlap)) {
    plan.pieces = {piece};
    const auto phases = RunLoad(plan, {&client}, nullptr);
    if (!phases.ok()) return phases.status();
    cells += phases->back().cells_built;
  }
  return cells;
}

absl::StatusOr<Json> RunSharing(const SharingSetting& setting, const Progress& progress) {
  const auto flight = LoadFlight(setting.scene_file, setting.path_file, setting.path_frames);
  if (!flight.ok()) return flight.status();
  const auto& [file, cameras] = *flight;
  Json runs = Json::array();
  for (const size_t clients : setting.clients) {
    const auto part = [&](double share) {
      progress((static_cast<double>(runs.size()) + share) /
               static_cast<double>(setting.clients.size()));
    };
    const auto figures = FlyTogether(setting, file, cameras, clients, part);
    if (!figures.ok()) return figures.status();
    const auto in_turn = BuildInTurn(setting, file, cameras, clients);
    if (!in_turn.ok()) return in_turn.status();
    Json json = LoadJson(*figures);
    json["clients"] = clients;
    json["cells_built_in_turn"] = *in_turn;
    runs.push_back(std::move(json));
  }
  return Json{{"runs", std::move(runs)}};
}

// Cells by those of the one client, who flies the whole path once.
double CellRatio(const Json& result, const Json& run) {
  const auto built = [](const Json& of) { return of.at("cells_built").get<double>(); };
  return built(run) / built(result.at("runs").at(0));
}

// By those of one client who flies the same frames.
double InTurnRatio(const Json& run) {
  return run.at("cells_built").get<double>() / run.at("cells_built_in_turn").get<double>();
}

std::vector<Plot> SharingPlots(const Json& result) {
  const PlotAxis clients{.label = "clients", .logarithmic = true};
  Plot cells{
      "cells built by N clients", clients, {}, {{"by those of one", {}}, {"same frames", {}}}};
  cells.y = {.label = "ratio", .bands = {{kMostCells, kMostCells, "goal for 16 clients"}}};
  Plot rate{"throughput, from an empty cache on",
            clients,
            {.label = "frames per second"},
            {{"frames/s", {}}}};
  Plot latency{"latency",
               clients,
               {.label = "ms", .logarithmic = true},
               {{"p50", {}}, {"p90", {}}, {"p99", {}}}};
  Plot hits{"hit rate over time", {.label = "seconds"}, {.label = "%", .min = 0, .max = 100}, {}};
  for (const Json& run : result.at("runs")) {
    const double count = run.at("clients");
    cells.series[0].points.emplace_back(count, CellRatio(result, run));
    cells.series[1].points.emplace_back(count, InTurnRatio(run));
    rate.series[0].points.emplace_back(count, run.at("frames_per_s").get<double>());
    for (PlotSeries& series : latency.series) {
      series.points.emplace_back(count, run.at("latency_ms").at(series.name).get<double>());
    }
    PlotSeries over_time{absl::StrCat(count, " clients"), {}};
    for (const Json& bucket : run.at("over_time")) {
      if (bucket.at("frames") == 0) continue;
      over_time.points.emplace_back(bucket.at("to_s").get<double>(),
                                    100 * bucket.at("hit_rate").get<double>());
    }
    hits.series.push_back(std::move(over_time));
  }
  return {cells, rate, latency, hits};
}

std::vector<ReportTable> SharingTables(const Json& result) {
  ReportTable table{{"clients", "frames", "cells built", "by those of one", "same frames",
                     "frames/s", "p50 ms", "p99 ms", "hit rate", "cache"}};
  for (const Json& run : result.at("runs")) {
    const Json& latency = run.at("latency_ms");
    table.rows.push_back(
        {Grouped(run.at("clients")), Grouped(run.at("frames")), Grouped(run.at("cells_built")),
         absl::StrFormat("%.2f", CellRatio(result, run)), absl::StrFormat("%.2f", InTurnRatio(run)),
         absl::StrFormat("%.1f", run.at("frames_per_s").get<double>()),
         absl::StrFormat("%.1f", latency.at("p50").get<double>()),
         absl::StrFormat("%.1f", latency.at("p99").get<double>()), Percent(run.at("hit_rate")),
         Bytes(run.at("cache_bytes"))});
  }
  return {table};
}

std::vector<ReportGoal> SharingGoals(const Json& result) {
  for (const Json& run : result.at("runs")) {
    if (run.at("clients") != kGoalClients) continue;
    const double ratio = CellRatio(result, run);
    return {{absl::StrCat("cells built by ", kGoalClients,
                          " clients on overlapping paths, by those of one that flies their union"),
             absl::StrCat("<= ", kMostCells), absl::StrFormat("%.2f", ratio), ratio <= kMostCells}};
  }
  return {};
}

}  // namespace

ReportSection SharingSection(const ReportOptions& options) {
  SharingSetting setting{.scene_file = absl::StrCat(options.scenes_dir, "/", kScene),
                         .path_file = absl::StrCat(options.scenes_dir, "/", kPath),
                         .side = options.quick ? 96 : 256,
                         .path_frames = options.quick ? 48 : 240,
                         .clients = {1, 4, 16, 64},
                         .threads = options.threads};
  ReportSection section{.id = "sharing", .title = "Sharing one cache"};
  section.text = absl::StrCat(
      "The path is cut into equally long pieces, one for each client, of which neighbours share "
      "half; all fly at the same time on a cache that starts empty. One client alone flies the "
      "whole path, which is the union of the pieces, once; for 'same frames' one client flies the "
      "pieces of all, one after the other. ",
      setting.path_frames, " cameras, ", setting.side, " x ", setting.side, " pixels, ray by ray.");
  section.command = absl::StrCat("linetree load --local --scene ", setting.scene_file, " --path ",
                                 setting.path_file, " --overlap ", kOverlap,
                                 " --clients N --width ", setting.side, " --height ", setting.side);
  section.parameters = {{"side", setting.side},
                        {"frames", setting.path_frames},
                        {"clients", setting.clients},
                        {"overlap", kOverlap},
                        {"scene", HashOfFile(setting.scene_file)},
                        {"path", HashOfFile(setting.path_file)}};
  section.run = [setting](const Progress& progress) { return RunSharing(setting, progress); };
  section.plots = SharingPlots;
  section.tables = SharingTables;
  section.goals = SharingGoals;
  return section;
}

}  // namespace linetree
