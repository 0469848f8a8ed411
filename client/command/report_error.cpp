// Section: what an epsilon costs and gives, in every scene.
#include <algorithm>
#include <iterator>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/error_sweep.h"
#include "client/command/local_client.h"
#include "client/command/report_sections.h"
#include "client/command/scene_files.h"
#include "client/command/table.h"

namespace linetree {
namespace {

using Json = nlohmann::json;

// Those of the paper's tables and pictures (sections 8.1 and 8.2).
const PlotBand kPaperEpsilons = {0.1, 0.5, "the paper's"};
// Where plots hold several scenes, these: one for each colour.
const std::vector<std::string> kShown = {"room",    "face",   "glass",  "many_lights",
                                         "balls_4", "tree_8", "rings_1"};

Json ErrorJson(const ErrorFigures& figures) {
  return {{"max", figures.max},
          {"p999", figures.p999},
          {"mean", figures.mean},
          {"pixels", figures.pixels},
          {"beyond", figures.beyond}};
}

Json RowJson(const ErrorSweepRow& row) {
  return {{"epsilon", row.epsilon},
          {"classical_ms", row.classical_ms},
          {"cold_ms", row.cold_ms},
          {"warm_ms", row.warm_ms},
          {"cold_hit_rate", row.cold_success},
          {"warm_hit_rate", row.warm_success},
          {"cold", ErrorJson(row.cold)},
          {"warm", ErrorJson(row.warm)}};
}

absl::StatusOr<Json> RunErrors(const std::vector<std::string>& files,
                               const ErrorSweepOptions& sweep, const Progress& progress) {
  Json scenes = Json::array();
  for (size_t i = 0; i < files.size(); ++i) {
    const absl::StatusOr<SceneFile> file = ReadSceneFileChecked(files[i]);
    if (!file.ok()) return file.status();
    if (file->scene->cameras.empty()) continue;
    ErrorSweepOptions options = sweep;
    options.request.camera = file->scene->cameras.front();
    LocalClient client(/*threads=*/1, CacheOptions{}.memory_bytes);
    const auto rows = SweepErrors(client, *file, file->name, options, [&](double share) {
      progress((static_cast<double>(i) + share) / static_cast<double>(files.size()));
    });
    if (!rows.ok()) return rows.status();
    Json points = Json::array();
    for (const ErrorSweepRow& row : *rows) points.push_back(RowJson(row));
    scenes.push_back({{"scene", file->name}, {"rows", std::move(points)}});
  }
  return Json{{"scenes", std::move(scenes)}};
}

using Value = double (*)(const Json& row);

PlotSeries ErrorSeries(const std::string& name, const Json& rows, Value x, Value y) {
  PlotSeries series{name, {}};
  for (const Json& row : rows) series.points.emplace_back(x(row), y(row));
  return series;
}

double Epsilon(const Json& row) { return row.at("epsilon"); }
double Cold(const Json& row) { return row.at("cold_ms"); }
double Warm(const Json& row) { return row.at("warm_ms"); }
double Classical(const Json& row) { return row.at("classical_ms"); }
double MaxError(const Json& row) { return row.at("warm").at("max"); }
double P999Error(const Json& row) { return row.at("warm").at("p999"); }
double MeanError(const Json& row) { return row.at("warm").at("mean"); }
double WarmGain(const Json& row) { return Classical(row) / Warm(row); }
uint64_t Beyond(const Json& row) {
  return row.at("cold").at("beyond").get<uint64_t>() + row.at("warm").at("beyond").get<uint64_t>();
}

std::vector<Plot> ErrorPlots(const Json& result) {
  const PlotAxis epsilon{.label = "epsilon", .min = 0, .max = 1, .bands = {kPaperEpsilons}};
  const PlotAxis gain{
      .label = "classical / warm", .logarithmic = true, .bands = {{1, 1, "as fast as classical"}}};
  const PlotAxis error{.label = "largest measured error of a pixel", .logarithmic = true};
  std::vector<Plot> plots = {{"run time against what was promised", epsilon, gain, {}},
                             {"run time against what was measured", error, gain, {}}};
  for (const Json& scene : result.at("scenes")) {
    const std::string name = scene.at("scene");
    const Json& rows = scene.at("rows");
    if (std::find(kShown.begin(), kShown.end(), name) != kShown.end()) {
      plots[0].series.push_back(ErrorSeries(name, rows, Epsilon, WarmGain));
      plots[1].series.push_back(ErrorSeries(name, rows, MaxError, WarmGain));
    }
    plots.push_back(
        {name + ": time over epsilon",
         epsilon,
         {.label = "ms"},
         {ErrorSeries("cold", rows, Epsilon, Cold), ErrorSeries("warm", rows, Epsilon, Warm),
          ErrorSeries("classical", rows, Epsilon, Classical)}});
    plots.push_back({name + ": error of warm frames over epsilon",
                     epsilon,
                     {.label = "relative error", .logarithmic = true},
                     {ErrorSeries("largest", rows, Epsilon, MaxError),
                      ErrorSeries("99.9 percentile", rows, Epsilon, P999Error),
                      ErrorSeries("mean", rows, Epsilon, MeanError),
                      ErrorSeries("promised", rows, Epsilon, Epsilon)}});
  }
  return plots;
}

std::vector<ReportTable> ErrorTables(const Json& result) {
  ReportTable table{{"scene", "epsilon", "classical ms", "cold ms", "warm ms", "hit rate, warm",
                     "largest error", "beyond"}};
  for (const Json& scene : result.at("scenes")) {
    for (const Json& row : scene.at("rows")) {
      table.rows.push_back({scene.at("scene"), absl::StrCat(Epsilon(row)),
                            absl::StrFormat("%.1f", Classical(row)),
                            absl::StrFormat("%.1f", Cold(row)), absl::StrFormat("%.1f", Warm(row)),
                            Percent(row.at("warm_hit_rate")),
                            absl::StrFormat("%.2g", MaxError(row)), absl::StrCat(Beyond(row))});
    }
  }
  return {table};
}

std::vector<ReportGoal> ErrorGoals(const Json& result) {
  uint64_t beyond = 0, pixels = 0;
  for (const Json& scene : result.at("scenes")) {
    for (const Json& row : scene.at("rows")) {
      beyond += Beyond(row);
      pixels += 2 * row.at("warm").at("pixels").get<uint64_t>();
    }
  }
  return {{"pixels beyond epsilon, all scenes", "0",
           absl::StrCat(Grouped(beyond), " of ", Grouped(pixels)), beyond == 0}};
}

}  // namespace

ReportSection ErrorSection(const ReportOptions& options) {
  ErrorSweepOptions sweep;
  sweep.request.width = sweep.request.height = options.quick ? 96 : 256;
  sweep.epsilons =
      options.quick ? std::vector<double>{0, 0.1, 0.5, 1}
                    : std::vector<double>{0, 0.01, 0.02, 0.05, 0.1, 0.15, 0.25, 0.35, 0.5, 0.75, 1};
  sweep.repeats = 3;
  const auto found = ScenesIn(options.scenes_dir);
  const std::vector<std::string> files = found.ok() ? *found : std::vector<std::string>();
  Json scenes = Json::object();
  for (const std::string& file : files) scenes[file] = HashOfFile(file);
  const int side = sweep.request.width;
  ReportSection section{.id = "error", .title = "Run time against error"};
  section.text = absl::StrCat(
      "For every scene and epsilon: the first frame of an empty cache (cold), the next one (warm) "
      "and a classical one, ",
      side, " x ", side, " pixels, one thread, ray by ray, medians of ", sweep.repeats,
      "; errors are those against the classical frame, relative to max(classical, white/1024), of "
      "the worst channel. The band marks the epsilons of the paper's tables and pictures.");
  section.command = absl::StrCat("linetree bench error --local --threads 1 --scene SCENE --width ",
                                 side, " --height ", side, " --repeat ", sweep.repeats);
  section.parameters = {
      {"scenes", scenes}, {"side", side}, {"epsilons", sweep.epsilons}, {"repeats", sweep.repeats}};
  section.run = [files, sweep, status = found.status()](const Progress& progress) {
    return status.ok() ? RunErrors(files, sweep, progress) : absl::StatusOr<Json>(status);
  };
  section.plots = ErrorPlots;
  section.tables = ErrorTables;
  section.goals = ErrorGoals;
  return section;
}

}  // namespace linetree
