// Sections: cached frames by packets against classical ones by packets, over what a scene and a
// picture have, and frame by frame.
#include <map>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/command/report_sections.h"
#include "client/command/scene_files.h"
#include "client/command/speed_report.h"
#include "client/command/table.h"

namespace linetree {
namespace {

using Json = nlohmann::json;

const PlotBand kEven = {1, 1, "as fast as classical"};
// As many as there are colours.
constexpr size_t kSeriesOfAPlot = 7;

SpeedPlan PlanOf(const ReportOptions& options) {
  SpeedPlan plan;
  plan.scenes_dir = options.scenes_dir;
  plan.base.options.width = plan.base.options.height = options.quick ? 192 : 512;
  plan.base.options.repeats = 3;
  plan.flights.still_frames = options.quick ? 3 : 12;
  return plan;
}

Json ParametersOf(const SpeedPlan& plan) {
  const FrameSpeedOptions& options = plan.base.options;
  return {{"side", options.width},
          {"repeats", options.repeats},
          {"frames", plan.flights.still_frames},
          {"epsilon", options.epsilon}};
}

std::string SettingText(const SpeedPlan& plan) {
  const FrameSpeedOptions& options = plan.base.options;
  return absl::StrCat(" Frames by packets, one thread, ", options.width, " x ", options.height,
                      " pixels where it does not say otherwise, epsilon ", options.epsilon,
                      "; cached and classical frames in turn, medians of ", options.repeats,
                      "; cold is the first frame of a cache, warm number ",
                      plan.flights.still_frames, " of the same view.");
}

std::string CommandOf(const SpeedPlan& plan, const std::string& more) {
  const FrameSpeedOptions& options = plan.base.options;
  return absl::StrCat("linetree bench speed", more, " --width ", options.width, " --height ",
                      options.height, " --repeat ", options.repeats, " --frames ",
                      plan.flights.still_frames);
}

std::vector<double> PointsOf(Sweep sweep, bool quick) {
  if (!quick) return DefaultPoints(sweep);
  switch (sweep) {
    case Sweep::kLights:
      return {1, 4, 16};
    case Sweep::kObjects:
      return {10, 100, 1000};
    case Sweep::kResolution:
      return {64, 128, 256};
    case Sweep::kDepth:
      return {1, 2, 4};
    default:
      return {1, 4};
  }
}

bool IsLogarithmic(const std::string& sweep) {
  return sweep == "lights" || sweep == "objects" || sweep == "resolution";
}

// A series for each scene and path; `value` of a row's path.
std::vector<PlotSeries> SeriesOf(const Json& rows, double (*value)(const Json& path)) {
  std::map<std::string, PlotSeries> by_name;
  for (const Json& row : rows) {
    for (const Json& path : row.at("paths")) {
      const std::string name = absl::StrCat(row.at("scene").get<std::string>(), ", ",
                                            path.at("path").get<std::string>());
      by_name[name].name = name;
      by_name[name].points.emplace_back(row.at("point").get<double>(), value(path));
    }
  }
  std::vector<PlotSeries> all;
  for (auto& [name, series] : by_name) all.push_back(std::move(series));
  return all;
}

double Gain(const Json& path) { return path.at("median_ratio"); }
double CachedNs(const Json& path) { return path.at("cached_ns_per_pixel").at("median"); }
double ClassicalNs(const Json& path) { return path.at("classical_ns_per_pixel").at("median"); }

std::vector<Plot> SweepSectionPlots(const Json& result) {
  const std::string name = result.at("sweep");
  const PlotAxis x{.label = name, .logarithmic = IsLogarithmic(name)};
  return {{"classical / cached over " + name,
           x,
           {.label = "ratio", .logarithmic = true, .bands = {kEven}},
           SeriesOf(result.at("rows"), Gain)},
          {"cached frames over " + name,
           x,
           {.label = "ns per pixel", .logarithmic = true},
           SeriesOf(result.at("rows"), CachedNs)}};
}

std::vector<ReportGoal> BeyondGoal(const std::string& what, const Json& rows) {
  uint64_t beyond = 0, pixels = 0;
  for (const Json& row : rows) {
    for (const Json& path : row.at("paths")) {
      beyond += path.at("beyond").get<uint64_t>();
      pixels += path.at("pixels").get<uint64_t>();
    }
  }
  return {{absl::StrCat("pixels beyond epsilon, ", what), "0",
           absl::StrCat(Grouped(beyond), " of ", Grouped(pixels)), beyond == 0}};
}

// The frames of one view, one after the other.
std::vector<Plot> FramesPlots(const Json& result) {
  const PlotAxis frame{.label = "frame of the same view"};
  const PlotAxis ratio{.label = "classical / cached", .logarithmic = true, .bands = {kEven}};
  std::vector<Plot> plots;
  for (const Json& row : result.at("rows")) {
    if (plots.empty() || plots.back().series.size() == kSeriesOfAPlot) {
      plots.push_back({"classical / cached, from a cold frame on", frame, ratio, {}});
    }
    PlotSeries series{row.at("scene"), {}};
    for (const Json& turn : row.at("paths").at(0).at("turns")) {
      series.points.emplace_back(series.points.size() + 1, turn.at("ratio").get<double>());
    }
    plots.back().series.push_back(std::move(series));
  }
  return plots;
}

std::vector<ReportTable> FramesTables(const Json& result) {
  ReportTable table{{"scene", "objects", "lights", "classical ns/px", "cold ratio", "warm ns/px",
                     "warm ratio", "memory", "largest error"}};
  const auto text = [](double value) { return absl::StrFormat("%.2f", value); };
  for (const Json& row : result.at("rows")) {
    const Json& cold = row.at("paths").at(0);
    const Json& warm = row.at("paths").at(1);
    table.rows.push_back({row.at("scene"), Grouped(row.at("objects")), Grouped(row.at("lights")),
                          text(ClassicalNs(warm)), text(Gain(cold)), text(CachedNs(warm)),
                          text(Gain(warm)), Bytes(warm.at("bytes")),
                          absl::StrFormat("%.2g", warm.at("largest_error").get<double>())});
  }
  return {table};
}

}  // namespace

ReportSection SweepSection(Sweep sweep, const ReportOptions& options) {
  const SpeedPlan plan = PlanOf(options);
  const std::vector<double> points = PointsOf(sweep, options.quick);
  const std::string name(NameOf(sweep));
  ReportSection section{.id = name, .title = absl::StrCat("Speed-up against ", name)};
  section.text = absl::StrCat(
      "Scenes that are made for the purpose: ", absl::StrJoin(DefaultMadeScenes(sweep), ", "), ".",
      SettingText(plan));
  section.command =
      CommandOf(plan, absl::StrCat(" --sweep ", name, " --points ", absl::StrJoin(points, ",")));
  section.parameters = ParametersOf(plan);
  section.parameters["points"] = points;
  section.run = [plan, sweep, points, name](const Progress& progress) -> absl::StatusOr<Json> {
    const auto rows = MeasureSweep(plan, sweep, points, progress);
    if (!rows.ok()) return rows.status();
    Json result = {{"sweep", name}, {"rows", Json::array()}};
    for (const SpeedRow& row : *rows) {
      result["rows"].push_back(SpeedJson(row));
      result["rows"].back()["point"] = row.point;
    }
    return result;
  };
  section.plots = SweepSectionPlots;
  section.goals = [name](const Json& result) {
    return BeyondGoal(absl::StrCat("sweep over ", name), result.at("rows"));
  };
  return section;
}

ReportSection FramesSection(const ReportOptions& options) {
  SpeedPlan plan = PlanOf(options);
  if (options.quick) {
    for (const char* name : {"room", "face", "glass", "many_lights"}) {
      plan.scenes.push_back(absl::StrCat(options.scenes_dir, "/", name, ".textproto"));
    }
  }
  ReportSection section{.id = "frames", .title = "Cold and warm frames"};
  section.text =
      absl::StrCat("The same view again and again, from an empty cache on.", SettingText(plan));
  section.command = CommandOf(plan, "");
  for (const std::string& scene : plan.scenes)
    absl::StrAppend(&section.command, " --scene ", scene);
  section.parameters = ParametersOf(plan);
  section.parameters["scenes"] = plan.scenes;
  section.run = [plan](const Progress& progress) -> absl::StatusOr<Json> {
    const auto rows = MeasureScenes(plan, progress);
    if (!rows.ok()) return rows.status();
    Json result = {{"rows", Json::array()}};
    for (const SpeedRow& row : *rows) result["rows"].push_back(SpeedJson(row));
    return result;
  };
  section.plots = FramesPlots;
  section.tables = FramesTables;
  section.goals = [](const Json& result) {
    return BeyondGoal("cold and warm frames", result.at("rows"));
  };
  return section;
}

}  // namespace linetree
