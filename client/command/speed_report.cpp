#include "client/command/speed_report.h"

#include <algorithm>
#include <functional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/table.h"

namespace linetree {
namespace {

std::string NameOf(SpeedPath path) {
  return std::string(kSpeedPathNames[static_cast<size_t>(path)]);
}
std::string Tenths(double value) { return absl::StrFormat("%.1f", value); }
std::string Hundredths(double value) { return absl::StrFormat("%.2f", value); }
std::string Range(const SpeedSpread& spread) {
  return absl::StrFormat("%.1f..%.1f", spread.least, spread.most);
}

double Share(uint64_t part, uint64_t all) {
  return all == 0 ? 0 : static_cast<double>(part) / static_cast<double>(all);
}
double HitsAgain(const PacketCounts& c) {
  return Share(c.hits_again, c.rays.intersect - c.rays.shadow);
}
double ShadowsAgain(const PacketCounts& c) { return Share(c.shadows_again, c.rays.shadow); }

nlohmann::json SpreadJson(const SpeedSpread& spread) {
  return {{"median", spread.median}, {"least", spread.least}, {"most", spread.most}};
}

nlohmann::json TracersJson(const SpeedStudy& s) {
  return {{"scalar_ns_per_pixel", SpreadJson(s.scalar)},
          {"packet_ns_per_pixel", SpreadJson(s.packet)},
          {"ratio", s.ratio},
          {"intersect", s.counts.rays.intersect},
          {"shadow", s.counts.rays.shadow},
          {"packets", s.counts.packets},
          {"shadow_packets", s.counts.shadow_packets},
          {"hits_again", HitsAgain(s.counts)},
          {"shadows_again", ShadowsAgain(s.counts)},
          {"different_topology", s.different_topology},
          {"different_counts", s.different_counts},
          {"largest_difference", s.largest_difference},
          {"allowed_difference", s.allowed_difference}};
}

nlohmann::json PathJson(const PathSpeed& path) {
  const FrameSpeed& flight = path.flight;
  nlohmann::json turns = nlohmann::json::array();
  for (const FrameSpeed::Turn& turn : flight.turns) {
    turns.push_back({{"classical_ns_per_pixel", SpreadJson(turn.classical)},
                     {"cached_ns_per_pixel", SpreadJson(turn.cached)},
                     {"ratio", turn.ratio}});
  }
  return {{"path", NameOf(path.path)},
          {"frames", path.frames},
          {"median_ratio", path.median_ratio},
          {"least_ratio", path.least_ratio},
          {"average_ratio", path.average_ratio},
          {"classical_ns_per_pixel", SpreadJson(path.classical)},
          {"cached_ns_per_pixel", SpreadJson(path.cached)},
          {"interpolated", flight.interpolated},
          {"replayed", flight.replayed},
          {"residual", flight.residual},
          {"memory", MemoryJson(flight.memory)},
          {"bytes", BytesOf(flight.memory)},
          {"pixels", flight.pixels},
          {"beyond", flight.beyond},
          {"largest_error", flight.largest_error},
          {"p999_error", flight.p999_error},
          {"turns", std::move(turns)}};
}

nlohmann::json StagesJson(const StageSpeed& stages) {
  const auto legs = [](const StageSpeed::Legs& l) -> nlohmann::json {
    return {{"lights", l.lights}, {"branches", l.branches}, {"all", l.all}};
  };
  const auto learning = [](const StageSpeed::Learning& l) -> nlohmann::json {
    return {{"probe", l.probe}, {"learn", l.learn}, {"all", l.all}};
  };
  return {{"eye", stages.eye},
          {"classical", legs(stages.classical)},
          {"warm", legs(stages.warm)},
          {"cold_learning", learning(stages.cold_learning)},
          {"warm_learning", learning(stages.warm_learning)}};
}

std::string_view NameOf(SpeedTarget::What what) {
  switch (what) {
    case SpeedTarget::What::kMedian:
      return "classical / cached";
    case SpeedTarget::What::kLeast:
      return "of every single frame";
    case SpeedTarget::What::kThreads:
      return "one thread / two";
  }
  return "";
}

std::string WhatOf(const TargetResult& result) {
  std::string what(NameOf(result.target.what));
  if (result.target.what != SpeedTarget::What::kThreads) return what;
  return absl::StrFormat("%s (classical: %.2f)", what, result.classical_threads);
}

using Value = std::function<double(const PathSpeed&)>;

void AddPoint(std::vector<PlotSeries>& all, const std::string& name, double x, double y) {
  auto series =
      std::find_if(all.begin(), all.end(), [&](const PlotSeries& s) { return s.name == name; });
  if (series == all.end()) series = all.insert(all.end(), {name, {}});
  series->points.emplace_back(x, y);
}

// A line for every scene and path.
std::vector<PlotSeries> SeriesOf(const std::vector<SpeedRow>& rows, const Value& value) {
  std::vector<PlotSeries> all;
  for (const SpeedRow& row : rows) {
    for (const PathSpeed& path : row.paths) {
      AddPoint(all, absl::StrCat(row.setting.name, " ", NameOf(path.path)), row.point, value(path));
    }
  }
  return all;
}

// One for every scene: its paths' classical frames differ little.
std::vector<PlotSeries> ClassicalSeries(const std::vector<SpeedRow>& rows) {
  std::vector<PlotSeries> all;
  for (const SpeedRow& row : rows) {
    AddPoint(all, row.setting.name + " classical", row.point, row.paths.front().classical.median);
  }
  return all;
}

}  // namespace

std::string TracerTable(const std::vector<SpeedRow>& rows) {
  Table table({{"scene"},
               {"objects", Align::kRight},
               {"lights", Align::kRight},
               {"scalar ns/px", Align::kRight},
               {"packet ns/px", Align::kRight},
               {"least..most", Align::kRight},
               {"ratio", Align::kRight},
               {"hits again", Align::kRight},
               {"shadows again", Align::kRight},
               {"other trees", Align::kRight},
               {"largest difference", Align::kRight},
               {"allowed", Align::kRight}});
  for (const SpeedRow& row : rows) {
    if (!row.tracers) continue;
    const SpeedStudy& s = *row.tracers;
    table.AddRow({row.setting.name, Grouped(s.objects), Grouped(s.lights), Tenths(s.scalar.median),
                  Tenths(s.packet.median), Range(s.packet), Tenths(s.ratio),
                  absl::StrFormat("%.3f %%", 100 * HitsAgain(s.counts)),
                  absl::StrFormat("%.3f %%", 100 * ShadowsAgain(s.counts)),
                  Grouped(s.different_topology), absl::StrFormat("%.1e", s.largest_difference),
                  absl::StrFormat("%.1e", s.allowed_difference)});
  }
  return table.ToString();
}

std::string PathTable(const std::vector<SpeedRow>& rows, const std::string& point) {
  std::vector<TableColumn> columns = {{"scene"}};
  if (!point.empty()) columns.push_back({point, Align::kRight});
  for (const char* title :
       {"objects", "lights", "path", "frames", "classical ns/px", "cached ns/px", "least..most",
        "ratio", "least", "average", "interpolated", "replayed", "cells", "bytes/cell", "memory",
        "max error", "p99.9", "beyond"}) {
    columns.push_back({title, Align::kRight});
  }
  Table table(std::move(columns));
  for (const SpeedRow& row : rows) {
    for (const PathSpeed& path : row.paths) {
      const FrameSpeed& f = path.flight;
      uint64_t tree_bytes = 0;
      for (const MemoryPart& part : f.memory) tree_bytes += part.cells > 0 ? part.bytes : 0;
      std::vector<std::string> cells = {row.setting.name};
      if (!point.empty()) cells.push_back(absl::StrCat(row.point));
      for (std::string& cell : std::vector<std::string>{
               Grouped(row.setting.scene->objects.size()),
               Grouped(row.setting.scene->lights.size()), NameOf(path.path), Grouped(path.frames),
               Tenths(path.classical.median), Tenths(path.cached.median), Range(path.cached),
               Hundredths(path.median_ratio), Hundredths(path.least_ratio),
               Hundredths(path.average_ratio), Percent(f.interpolated), Percent(f.replayed),
               Grouped(CellsOf(f.memory)),
               absl::StrFormat("%.0f", Share(tree_bytes, CellsOf(f.memory))),
               Bytes(BytesOf(f.memory)), absl::StrFormat("%.2g", f.largest_error),
               absl::StrFormat("%.2g", f.p999_error), Grouped(f.beyond)}) {
        cells.push_back(std::move(cell));
      }
      table.AddRow(std::move(cells));
    }
  }
  return table.ToString();
}

std::string StageTable(const std::vector<SpeedRow>& rows) {
  Table table({{"scene"},
               {"frame"},
               {"eye", Align::kRight},
               {"lights", Align::kRight},
               {"branches", Align::kRight},
               {"all", Align::kRight},
               {"of it: probing", Align::kRight},
               {"learning", Align::kRight}});
  for (const SpeedRow& row : rows) {
    if (!row.stages) continue;
    const StageSpeed& s = *row.stages;
    const auto add = [&](const char* frame, const StageSpeed::Legs& legs) {
      return std::vector<std::string>{row.setting.name,      frame,
                                      Tenths(s.eye),         Tenths(legs.lights),
                                      Tenths(legs.branches), Tenths(legs.all)};
    };
    std::vector<std::string> classical = add("classical", s.classical), warm = add("warm", s.warm);
    classical.insert(classical.end(), {"", ""});
    warm.insert(warm.end(), {Tenths(s.warm_learning.probe), Tenths(s.warm_learning.learn)});
    table.AddRow(std::move(classical));
    table.AddRow(std::move(warm));
    table.AddRow({row.setting.name, "cold", "", "", "", Tenths(s.cold_learning.all),
                  Tenths(s.cold_learning.probe), Tenths(s.cold_learning.learn)});
  }
  return table.ToString();
}

std::string TargetTable(const std::vector<TargetResult>& results) {
  Table table({{"scene"},
               {"pixels"},
               {"depth", Align::kRight},
               {"epsilon", Align::kRight},
               {"samples", Align::kRight},
               {"path"},
               {"what"},
               {"to reach", Align::kRight},
               {"measured", Align::kRight},
               {"met"},
               {"without lights", Align::kRight},
               {"eye ns/px", Align::kRight},
               {"branches", Align::kRight},
               {"lights", Align::kRight},
               {"max error", Align::kRight},
               {"beyond", Align::kRight}});
  for (const TargetResult& result : results) {
    const SpeedTarget& t = result.target;
    const auto roof = [&](const auto& text) {
      return result.roofline ? text(*result.roofline) : std::string("-");
    };
    table.AddRow({t.scene, absl::StrCat(t.width, " x ", t.height), absl::StrCat(t.max_depth),
                  absl::StrCat(t.epsilon), absl::StrCat(t.samples), NameOf(t.path), WhatOf(result),
                  Hundredths(t.goal), Hundredths(result.measured), result.IsMet() ? "yes" : "no",
                  roof([](const Roofline& r) { return Hundredths(r.Best()); }),
                  roof([](const Roofline& r) { return Tenths(r.eye); }),
                  roof([](const Roofline& r) { return Tenths(r.branches); }),
                  roof([](const Roofline& r) { return Tenths(r.lights); }),
                  absl::StrFormat("%.2g", result.largest_error), Grouped(result.beyond)});
  }
  return table.ToString();
}

nlohmann::json MemoryJson(const std::vector<MemoryPart>& parts) {
  nlohmann::json json = nlohmann::json::array();
  for (const MemoryPart& part : parts) {
    json.push_back({{"name", std::string(part.name)}, {"bytes", part.bytes}});
    if (!part.has_cells) continue;
    json.back()["cells"] = part.cells;
    json.back()["bytes_per_cell"] = part.BytesPerCell();
  }
  return json;
}

nlohmann::json SpeedJson(const SpeedRow& row) {
  nlohmann::json json = nlohmann::json::object();
  if (row.tracers) json = TracersJson(*row.tracers);
  const FrameSpeedOptions& options = row.setting.options;
  json.update({{"scene", row.setting.name},
               {"objects", row.setting.scene->objects.size()},
               {"lights", row.setting.scene->lights.size()},
               {"width", options.width},
               {"height", options.height},
               {"pixels", options.width * options.height},
               {"repeats", options.repeats},
               {"epsilon", options.epsilon},
               {"threads", row.setting.threads},
               {"samples", options.sampling.samples},
               {"max_depth", options.limits.max_depth},
               {"min_weight", options.limits.min_weight}});
  json["paths"] = nlohmann::json::array();
  for (const PathSpeed& path : row.paths) json["paths"].push_back(PathJson(path));
  if (row.stages) json["stages_ns_per_pixel"] = StagesJson(*row.stages);
  return json;
}

nlohmann::json TargetJson(const TargetResult& result) {
  const SpeedTarget& t = result.target;
  nlohmann::json json = {{"scene", t.scene},       {"width", t.width},
                         {"height", t.height},     {"max_depth", t.max_depth},
                         {"epsilon", t.epsilon},   {"samples", t.samples},
                         {"path", NameOf(t.path)}, {"what", std::string(NameOf(t.what))},
                         {"goal", t.goal},         {"measured", result.measured},
                         {"met", result.IsMet()},  {"largest_error", result.largest_error},
                         {"beyond", result.beyond}};
  if (t.what == SpeedTarget::What::kThreads) json["classical_threads"] = result.classical_threads;
  if (result.roofline) {
    const Roofline& r = *result.roofline;
    json["roofline"] = {{"best", r.Best()},
                        {"eye_ns_per_pixel", r.eye},
                        {"branches_ns_per_pixel", r.branches},
                        {"lights_ns_per_pixel", r.lights},
                        {"classical_ns_per_pixel", r.classical}};
  }
  return json;
}

std::vector<Plot> SweepPlots(Sweep sweep, const std::vector<SpeedRow>& rows) {
  const std::string name(linetree::NameOf(sweep));
  PlotAxis x{.label = name};
  x.logarithmic = sweep != Sweep::kEpsilon && sweep != Sweep::kDepth && sweep != Sweep::kThreads &&
                  sweep != Sweep::kSamples;
  std::vector<PlotSeries> times = SeriesOf(rows, [](auto& p) { return p.cached.median; });
  for (PlotSeries& series : ClassicalSeries(rows)) times.push_back(std::move(series));
  return {{"classical / cached over " + name,
           x,
           {.label = "ratio"},
           SeriesOf(rows, [](auto& p) { return p.median_ratio; })},
          {"least of single frames over " + name,
           x,
           {.label = "ratio"},
           SeriesOf(rows, [](auto& p) { return p.least_ratio; })},
          {"time over " + name, x, {.label = "ns per pixel", .logarithmic = true}, times},
          {"largest error over " + name,
           x,
           {.label = "relative error", .logarithmic = true},
           SeriesOf(rows, [](auto& p) { return p.flight.largest_error; })}};
}

}  // namespace linetree
