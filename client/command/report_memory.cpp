// Section: what is kept for a scene while a camera flies through it.
#include "absl/strings/str_cat.h"
#include "client/command/load_run.h"
#include "client/command/local_client.h"
#include "client/command/report_flight.h"
#include "client/command/report_sections.h"
#include "client/command/table.h"

namespace linetree {
namespace {

using Json = nlohmann::json;

constexpr size_t kMemoryLaps = 2;

constexpr ReportFlight kMemoryFlights[] = {{"room.textproto", "room_walk"},
                                           {"face.textproto", "face_walk"},
                                           {"glass.textproto", "glass_orbit"},
                                           {"spd/balls_3.nff", "balls_orbit"},
                                           {"spd/tree_8.nff", "tree_orbit"}};

Json PartsJson(const v1::GetStatsReply& stats) {
  Json parts = Json::array();
  for (const auto& part : stats.scenes(0).memory()) {
    parts.push_back({{"name", part.name()}, {"bytes", part.bytes()}, {"cells", part.cells()}});
  }
  return parts;
}

// One client, lap after lap.
absl::StatusOr<Json> FlyWithParts(const LoadedFlight& flight, int side, int threads,
                                  const Progress& progress) {
  const auto& [file, cameras] = flight;
  LocalClient client(threads, CacheOptions{}.memory_bytes);
  if (auto info = SendScene(client, file, file.name, false); !info.ok()) return info.status();
  LoadPlan plan{.scene = file.name};
  plan.frame.width = plan.frame.height = side;
  plan.pieces = PlanPieces(1, {cameras.size()}, std::nullopt);
  plan.frames_each = kMemoryLaps * cameras.size();
  plan.paths = {cameras};
  const auto phases = RunLoad(plan, {&client}, progress);
  if (!phases.ok()) return phases.status();
  Json bytes = Json::array();
  for (const LoadSample& sample : phases->back().samples) bytes.push_back(sample.stats.cache_bytes);
  const auto stats = client.GetStats(file.name);
  if (!stats.ok()) return stats.status();
  return Json{{"cache_bytes", std::move(bytes)}, {"memory", PartsJson(*stats)}};
}

std::vector<Plot> MemoryPlots(const Json& result) {
  Plot plot{
      "memory of the cache over a path, flown twice", {.label = "frame"}, {.label = "MiB"}, {}};
  for (const Json& flight : result.at("flights")) {
    PlotSeries series{flight.at("scene"), {}};
    for (const Json& bytes : flight.at("cache_bytes")) {
      series.points.emplace_back(series.points.size() + 1, bytes.get<double>() / (1 << 20));
    }
    plot.series.push_back(std::move(series));
  }
  return {plot};
}

std::vector<ReportTable> MemoryTables(const Json& result) {
  ReportTable table{{"scene", "what", "bytes", "cells"}};
  for (const Json& flight : result.at("flights")) {
    for (const Json& part : flight.at("memory")) {
      table.rows.push_back({flight.at("scene"), part.at("name"), Bytes(part.at("bytes")),
                            Grouped(part.at("cells"))});
    }
  }
  return {table};
}

}  // namespace

ReportSection MemorySection(const ReportOptions& options) {
  const std::string folder = options.scenes_dir;
  const int side = options.quick ? 96 : 512;
  ReportSection section{.id = "memory", .title = "Memory over a path"};
  section.text = absl::StrCat(
      "One client flies each path twice, ", side, " x ", side,
      " pixels, ray by ray; the plot shows what is within the budget, the table all that is kept "
      "at the end.");
  section.command = absl::StrCat(
      "linetree load --local --scene SCENE --path PATH --clients 1 "
      "--frames FRAMES --width ",
      side, " --height ", side, " --csv FILE");
  section.parameters = {{"side", side}, {"laps", kMemoryLaps}};
  AddFlightFiles(folder, kMemoryFlights, section);
  section.run = [folder, side, threads = options.threads](const Progress& progress) {
    return FlyAll(folder, kMemoryFlights, progress,
                  [&](const LoadedFlight& flight, const Progress& part) {
                    return FlyWithParts(flight, side, threads, part);
                  });
  };
  section.plots = MemoryPlots;
  section.tables = MemoryTables;
  return section;
}

}  // namespace linetree
