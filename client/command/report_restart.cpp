// Section: what a server knows again after it was started anew.
#include <unistd.h>

#include <filesystem>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/report_flight.h"
#include "client/command/report_sections.h"
#include "client/command/table.h"
#include "core/io/stats_json.h"
#include "core/store/cell_store.h"

namespace linetree {
namespace {

using Json = nlohmann::json;

constexpr size_t kRestartLaps = 2;
// Of the hit rate that there was before, and in how many frames it is to be there again.
constexpr double kWantedShare = 0.9;
constexpr int kWantedFrames = 1;

constexpr ReportFlight kRestartFlights[] = {{"room.textproto", "room_walk"},
                                            {"spd/balls_4.nff", "balls_orbit"},
                                            {"glass.textproto", "glass_orbit"},
                                            {"spd/tree_8.nff", "tree_orbit"}};

// A host whose cells are kept.
struct KeptHost {
  KeptHost(CellStore& store, const std::string& name, std::shared_ptr<const Scene> scene)
      : host(std::move(scene)) {
    pages = store.Attach(name, {host.scene(), host.surfaces(), host.paths()});
    host.Keep(pages);
  }
  SceneHost host;
  std::shared_ptr<ScenePages> pages;
};

// Of frames along the cameras.
absl::StatusOr<Json> HitRates(SceneHost& host, const std::vector<Camera>& cameras, int side,
                              WorkerPool& pool, const std::function<void()>& done) {
  Json rates = Json::array();
  for (const Camera& camera : cameras) {
    const auto frame =
        host.RenderFrame({.camera = camera, .width = side, .height = side, .options = {}}, pool);
    if (!frame.ok()) return frame.status();
    rates.push_back(HitRate(frame->stats));
    done();
  }
  return rates;
}

absl::StatusOr<Json> Restart(const LoadedFlight& flight, int side, WorkerPool& pool,
                             const Progress& progress) {
  const SceneFile& file = flight.file;
  const std::vector<Camera>& cameras = flight.cameras;
  const auto data = std::filesystem::temp_directory_path() /
                    absl::StrCat("linetree-restart-", getpid(), "-", file.name);
  const absl::Cleanup remove = [&] {
    std::error_code ignored;
    std::filesystem::remove_all(data, ignored);
  };
  double frames = 0;
  const auto done = [&] {
    progress(++frames / static_cast<double>((kRestartLaps + 1) * cameras.size()));
  };
  const auto open = [&] { return CellStore::Open({.folder = data.string()}, [](const auto&) {}); };
  Json json;
  {
    auto store = open();
    if (!store.ok()) return store.status();
    KeptHost kept(**store, file.name, file.scene);
    for (size_t lap = 0; lap < kRestartLaps; ++lap) {
      auto rates = HitRates(kept.host, cameras, side, pool, done);
      if (!rates.ok()) return rates.status();
      json[lap == 0 ? "cold" : "warm"] = *std::move(rates);
    }
  }
  auto store = open();
  if (!store.ok()) return store.status();
  KeptHost kept(**store, file.name, file.scene);
  auto rates = HitRates(kept.host, cameras, side, pool, done);
  if (!rates.ok()) return rates.status();
  json["restarted"] = *std::move(rates);
  const StoreCounts counts = kept.pages->counts();
  json["cells"] = counts.cells_restored;
  json["restore_ms"] = counts.restore_ms;
  json["used_bytes"] = (*store)->sizes().used_bytes;
  return json;
}

// The first frame, from 1 on, that has the share of what the same frame had before; 0: none.
int FramesUntilWarm(const Json& flight) {
  const Json &before = flight.at("warm"), &now = flight.at("restarted");
  for (size_t i = 0; i < now.size(); ++i) {
    if (now[i].get<double>() >= kWantedShare * before[i].get<double>()) {
      return static_cast<int>(i) + 1;
    }
  }
  return 0;
}

std::vector<Plot> RestartPlots(const Json& result) {
  std::vector<Plot> plots;
  for (const Json& flight : result.at("flights")) {
    Plot plot{absl::StrCat(flight.at("scene").get<std::string>(), ": hit rate after a restart"),
              {.label = "frame of the path"},
              {.label = "hit rate", .min = 0, .max = 1},
              {}};
    for (const char* run : {"cold", "warm", "restarted"}) {
      PlotSeries series{run, {}};
      for (const Json& rate : flight.at(run)) {
        series.points.emplace_back(series.points.size() + 1, rate.get<double>());
      }
      plot.series.push_back(std::move(series));
    }
    plots.push_back(std::move(plot));
  }
  return plots;
}

std::vector<ReportTable> RestartTables(const Json& result) {
  ReportTable table{{"scene", "first frame: cold", "warm", "restarted", "cells", "on the disk",
                     "read and restored in"}};
  for (const Json& flight : result.at("flights")) {
    table.rows.push_back({flight.at("scene"), Percent(flight.at("cold")[0]),
                          Percent(flight.at("warm")[0]), Percent(flight.at("restarted")[0]),
                          Grouped(flight.at("cells")), Bytes(flight.at("used_bytes")),
                          absl::StrFormat("%.1f ms", flight.at("restore_ms").get<double>())});
  }
  return {table};
}

std::vector<ReportGoal> RestartGoals(const Json& result) {
  std::vector<ReportGoal> goals;
  for (const Json& flight : result.at("flights")) {
    const int frames = FramesUntilWarm(flight);
    goals.push_back({absl::StrCat("frames until 90 % of the former hit rate, ",
                                  flight.at("scene").get<std::string>()),
                     absl::StrCat("at most ", kWantedFrames),
                     frames == 0 ? "more than the path has" : absl::StrCat(frames),
                     frames > 0 && frames <= kWantedFrames});
  }
  return goals;
}

}  // namespace

ReportSection RestartSection(const ReportOptions& options) {
  const std::string folder = options.scenes_dir;
  const int side = options.quick ? 96 : 512;
  ReportSection section{.id = "restart", .title = "Restart"};
  section.text = absl::StrCat(
      "A path is flown twice, ", side, " x ", side,
      " pixels, ray by ray, and a third time by a cache that begins with what the first one has "
      "left on the disk. Hit rates are shares of the pixels that see something.");
  section.command = "linetree bench report --section restart -o DIR";
  section.parameters = {{"side", side}, {"laps", kRestartLaps}};
  AddFlightFiles(folder, kRestartFlights, section);
  section.run = [folder, side, threads = options.threads](const Progress& progress) {
    WorkerPool pool(threads);
    return FlyAll(folder, kRestartFlights, progress,
                  [&](const LoadedFlight& flight, const Progress& part) {
                    return Restart(flight, side, pool, part);
                  });
  };
  section.plots = RestartPlots;
  section.tables = RestartTables;
  section.goals = RestartGoals;
  return section;
}

}  // namespace linetree
