// Section: latency against the rate at which frames are asked for.
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/load_run.h"
#include "client/command/local_client.h"
#include "client/command/report_flight.h"
#include "client/command/report_sections.h"
#include "client/command/scene_files.h"
#include "client/command/table.h"

namespace linetree {
namespace {

using Json = nlohmann::json;

constexpr size_t kClients = 8;
// Of what the same clients reach in a closed loop.
constexpr double kRateShares[] = {0.25, 0.5, 0.75, 0.9, 1.1};

struct LoadSetting {
  std::string scene_file, path_file;
  int side = 256;
  size_t frames_each = 0;
  int threads = 0;
};

absl::StatusOr<Json> RunLoads(const LoadSetting& setting, const Progress& progress) {
  const auto flight = LoadFlight(setting.scene_file, setting.path_file);
  if (!flight.ok()) return flight.status();
  const auto& [file, cameras] = *flight;
  LocalClient client(setting.threads, CacheOptions{}.memory_bytes);
  if (auto info = SendScene(client, file, file.name, false); !info.ok()) return info.status();
  LoadPlan plan{.scene = file.name};
  plan.frame.width = plan.frame.height = setting.side;
  plan.paths = {cameras};
  plan.pieces = PlanPieces(kClients, {cameras.size()}, std::nullopt);
  plan.frames_each = setting.frames_each;
  plan.warm_up_frames = setting.frames_each;
  const std::vector<Client*> clients(kClients, &client);
  const auto closed = RunLoad(plan, clients, nullptr);
  if (!closed.ok()) return closed.status();
  const LoadFigures capacity = SummarizeLoad(closed->back());
  Json result = {{"warm_up", LoadJson(SummarizeLoad(closed->front()))},
                 {"closed", LoadJson(capacity)},
                 {"open", Json::array()}};
  plan.warm_up_frames = 0;
  for (const double share : kRateShares) {
    const auto part = [&](double of) {
      progress((static_cast<double>(result["open"].size()) + 1 + of) /
               (1 + std::size(kRateShares)));
    };
    plan.arrivals =
        ArrivalOptions{.rate = share * capacity.frames_per_s, .kind = ArrivalKind::kPoisson};
    const auto open = RunLoad(plan, clients, part);
    if (!open.ok()) return open.status();
    Json json = LoadJson(SummarizeLoad(open->back()));
    json["share"] = share;
    json["rate"] = plan.arrivals->rate;
    result["open"].push_back(std::move(json));
  }
  return result;
}

std::vector<Plot> RatePlots(const Json& result) {
  Plot latency{"latency from when a frame was to begin",
               {.label = "frames asked for, by what a closed loop reaches"},
               {.label = "ms", .logarithmic = true},
               {{"p50", {}}, {"p90", {}}, {"p99", {}}}};
  latency.x.bands = {{1, 1, "capacity"}};
  for (const Json& run : result.at("open")) {
    for (PlotSeries& series : latency.series) {
      series.points.emplace_back(run.at("share").get<double>(),
                                 run.at("latency_ms").at(series.name).get<double>());
    }
  }
  Plot sources{"answers from an empty cache on", {.label = "seconds"}, {.label = "%"}, {}};
  sources.y.min = 0;
  sources.y.max = 100;
  for (const char* name : {"interpolated", "replayed", "residual", "traced"}) {
    PlotSeries series{name, {}};
    for (const Json& bucket : result.at("warm_up").at("over_time")) {
      if (bucket.at("frames") == 0) continue;
      series.points.emplace_back(bucket.at("to_s").get<double>(),
                                 100 * bucket.at("sources").at(name).get<double>());
    }
    sources.series.push_back(std::move(series));
  }
  return {latency, sources};
}

std::vector<ReportTable> RateTables(const Json& result) {
  ReportTable table{{"frames/s asked for", "served", "p50 ms", "p90 ms", "p99 ms", "wait p99 ms",
                     "late", "hit rate"}};
  const auto text = [](const Json& value) { return absl::StrFormat("%.1f", value.get<double>()); };
  const auto add = [&](const std::string& rate, const Json& run) {
    const Json& latency = run.at("latency_ms");
    table.rows.push_back({rate, text(run.at("frames_per_s")), text(latency.at("p50")),
                          text(latency.at("p90")), text(latency.at("p99")),
                          text(run.at("wait_ms").at("p99")), Grouped(run.at("late")),
                          Percent(run.at("hit_rate"))});
  };
  add("closed loop, cold", result.at("warm_up"));
  add("closed loop", result.at("closed"));
  for (const Json& run : result.at("open")) add(text(run.at("rate")), run);
  return {table};
}

}  // namespace

ReportSection LoadSection(const ReportOptions& options) {
  LoadSetting setting{.scene_file = absl::StrCat(options.scenes_dir, "/room.textproto"),
                      .path_file = absl::StrCat(options.scenes_dir, "/paths/room_walk.textproto"),
                      .side = options.quick ? 64 : 256,
                      .frames_each = options.quick ? size_t{6} : size_t{60},
                      .threads = options.threads};
  ReportSection section{.id = "load", .title = "Latency under load"};
  section.text = absl::StrCat(
      kClients,
      " clients walk through the room: first as fast as they can (closed loop), from an "
      "empty cache and again; then frames begin at random moments (a Poisson process), at shares "
      "of the rate that was reached. ",
      setting.side, " x ", setting.side, " pixels, ray by ray, in one process.");
  section.command = absl::StrCat("linetree load --local --scene ", setting.scene_file, " --path ",
                                 setting.path_file, " --clients ", kClients, " --frames ",
                                 setting.frames_each, " --width ", setting.side, " --height ",
                                 setting.side, " --rate RATE --arrivals poisson");
  section.parameters = {{"side", setting.side},
                        {"clients", kClients},
                        {"frames", setting.frames_each},
                        {"shares", kRateShares},
                        {"scene", HashOfFile(setting.scene_file)},
                        {"path", HashOfFile(setting.path_file)}};
  section.run = [setting](const Progress& progress) { return RunLoads(setting, progress); };
  section.plots = RatePlots;
  section.tables = RateTables;
  return section;
}

}  // namespace linetree
