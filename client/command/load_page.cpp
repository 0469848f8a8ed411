#include "client/command/load_page.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/table.h"
#include "core/io/html_page.h"

namespace linetree {
namespace {

using Row = std::vector<std::string>;

std::string Ms(double ms) { return absl::StrFormat("%.1f", ms); }

Row PartRow(const char* name, const Quantiles& q) {
  return {name, Ms(q.p50), Ms(q.p90), Ms(q.p99), Ms(q.max)};
}

const Row kPartTitles = {"ms", "p50", "p90", "p99", "max"};

std::vector<Row> PartRows(const LoadFigures& figures) {
  return {PartRow("latency", figures.latency),  PartRow("wait", figures.wait),
          PartRow("queue", figures.queue),      PartRow("render", figures.render),
          PartRow("encode", figures.encode),    PartRow("network", figures.network),
          PartRow("light calls", figures.light)};
}

const Row kTimeTitles = {"seconds",  "frames",   "hit rate", "interpolated",
                         "replayed", "residual", "traced"};

std::vector<Row> TimeRows(const LoadFigures& figures) {
  std::vector<Row> rows;
  for (const LoadBucket& bucket : figures.buckets) {
    if (bucket.frames == 0) continue;
    const SourceCounts& of = bucket.sources;
    rows.push_back({absl::StrFormat("%.2f", bucket.to_s), Grouped(bucket.frames),
                    Percent(of.HitRate()), Percent(of.Share(of.interpolated)),
                    Percent(of.Share(of.replayed)), Percent(of.Share(of.residual)),
                    Percent(of.Share(of.traced))});
  }
  return rows;
}

std::vector<Row> SumRows(const LoadFigures& figures) {
  return {{"frames", absl::StrFormat("%s in %.2f s: %.2f frames/s", Grouped(figures.frames),
                                     figures.seconds, figures.frames_per_s)},
          {"refused", Grouped(figures.refused)},
          {"late", absl::StrCat(Grouped(figures.late), ", not begun ", Grouped(figures.not_begun),
                                ", overtaken ", Grouped(figures.overtaken))},
          {"hit rate", Percent(figures.sources.HitRate())},
          {"received", Bytes(figures.wire_bytes)},
          {"cells",
           absl::StrCat(Grouped(figures.cells_built), " built, ", Grouped(figures.cells_evicted),
                        " evicted, ", Bytes(figures.cache_bytes), " at the end")}};
}

std::string PhaseText(const LoadFigures& figures) {
  std::string text = absl::StrCat(figures.phase, "\n");
  for (const Row& row : SumRows(figures))
    absl::StrAppendFormat(&text, "%-11s %s\n", row[0], row[1]);
  return absl::StrCat(text, TextTable(kPartTitles, PartRows(figures)), "\n");
}

}  // namespace

bool LoadResult::MeetsObjectives() const {
  return std::all_of(objectives.begin(), objectives.end(),
                     [this](const LoadObjective& wanted) { return IsMet(wanted, measured()); });
}

std::string LoadText(const LoadResult& result) {
  std::string text;
  for (const LoadFigures& figures : result.figures) absl::StrAppend(&text, PhaseText(figures));
  absl::StrAppend(&text, TextTable(kTimeTitles, TimeRows(result.measured())));
  if (!result.changes.empty()) absl::StrAppend(&text, "\n", ChangeTable(result.changes));
  if (!result.objectives.empty()) {
    absl::StrAppend(&text, "\n", ObjectiveTable(result.objectives, result.measured()));
  }
  return text;
}

nlohmann::json LoadResultJson(const LoadResult& result) {
  nlohmann::json json = LoadJson(result.measured());
  if (result.figures.size() > 1) json["warm_up"] = LoadJson(result.figures.front());
  json["metrics"] = MetricsJson(result.measured());
  json["provenance"] = ProvenanceJson(result.provenance);
  if (!result.objectives.empty()) {
    json["objectives"] = ObjectivesJson(result.objectives, result.measured());
  }
  if (!result.changes.empty()) json["compared"] = ChangesJson(result.changes);
  return json;
}

std::vector<Plot> LoadResultPlots(const LoadResult& result) {
  std::vector<Plot> plots;
  for (size_t i = 0; i < result.phases.size(); ++i) {
    const std::string title = absl::StrCat(result.title, ", ", result.phases[i].name);
    for (Plot& plot : LoadPlots(result.phases[i], result.figures[i], title)) {
      plots.push_back(std::move(plot));
    }
  }
  return plots;
}

std::string LoadHtml(const LoadResult& result) {
  HtmlPage page(absl::StrCat("Load test: ", result.title));
  const std::string source = result.provenance.ToString();
  page.Paragraph(source);
  if (!result.objectives.empty()) {
    page.Heading("Objectives");
    page.Verbatim(ObjectiveTable(result.objectives, result.measured()));
  }
  if (!result.changes.empty()) {
    page.Heading("Compared with the run before");
    page.Verbatim(ChangeTable(result.changes));
  }
  for (size_t i = 0; i < result.phases.size(); ++i) {
    const LoadFigures& figures = result.figures[i];
    page.Heading(figures.phase, figures.phase);
    page.Table({"", ""}, SumRows(figures));
    page.Table(kPartTitles, PartRows(figures));
    page.Paragraph(
        "Latency runs from when a frame was to begin. Wait: until a client was free; queue, render "
        "and encode: what the server says; network: the rest, the client's own work included.");
    page.Figure(SvgPlots(LoadPlots(result.phases[i], figures, result.title)), source);
    page.Table(kTimeTitles, TimeRows(figures));
  }
  return page.ToString();
}

}  // namespace linetree
