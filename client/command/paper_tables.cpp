#include "client/command/paper_tables.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/table.h"
#include "core/io/load_scene.h"
#include "core/io/stats_json.h"

namespace linetree {
namespace {

// Base, ip and classical counts with the ratio, of Intersect and of Shade, then the success. Table
// 1 heads its shade counts Tot, Base, Ip; the sums show that they stand in the order base, ip,
// total.
std::vector<PaperRow> PrintedFace() {
  return {{"frame1", {257, 235, 466, 1.06}, {54, 83, 159, 0.86}, 0.70},
          {"frame2", {266, 64, 486, 0.63}, {56, 23, 166, 0.47}, 0.71},
          {"frame3", {276, 43, 506, 0.59}, {57, 15, 172, 0.42}, 0.71},
          {"frame4", {273, 48, 502, 0.60}, {57, 17, 171, 0.44}, 0.71},
          {"frame5", {270, 63, 495, 0.63}, {56, 23, 169, 0.47}, 0.71}};
}

std::vector<PaperRow> PrintedRoom() {
  return {{"frame1", {166, 304, 384, 1.31}, {24, 78, 91, 1.13}, 0.76},
          {"frame2", {162, 146, 384, 0.72}, {23, 40, 91, 0.69}, 0.77},
          {"frame3", {161, 106, 383, 0.58}, {22, 29, 90, 0.56}, 0.78},
          {"frame4", {160, 107, 377, 0.59}, {23, 27, 88, 0.56}, 0.77},
          {"frame5", {159, 114, 370, 0.62}, {23, 29, 87, 0.60}, 0.76}};
}

double Thousands(uint64_t n) { return static_cast<double>(n) / 1000; }

MeasuredRow RowOf(const std::string& label, const Frame& cached, const Frame& classical,
                  double white, double epsilon) {
  MeasuredRow measured;
  const FrameStats& s = cached.stats;
  PaperRow& row = measured.row;
  row.label = label;
  row.intersect = {Thousands(s.base.intersect), Thousands(s.ip.intersect),
                   Thousands(classical.stats.base.intersect)};
  row.shade = {Thousands(s.base.shade), Thousands(s.ip.shade),
               Thousands(classical.stats.base.shade)};
  const uint64_t covered = s.interpolated + s.traced;
  row.success =
      covered == 0 ? 0 : static_cast<double>(s.interpolated) / static_cast<double>(covered);
  measured.stats = s;
  CompareOptions compare;
  compare.white = white;
  compare.floor = white * kFloorOfWhite;
  compare.max_relative_error = epsilon;
  measured.error = CompareRadiance(cached.radiance, classical.radiance, compare);
  return measured;
}

std::string Count(double thousands) { return absl::StrFormat("%.0f", thousands); }
std::string Ratio(double ratio) { return absl::StrFormat("%.2f", ratio); }

std::vector<std::string> Cells(const PaperRow& row) {
  std::vector<std::string> cells{row.label};
  for (const PaperCounts* c : {&row.intersect, &row.shade}) {
    for (const double n : {c->base, c->ip, c->Total(), c->classical}) {
      cells.push_back(c->classical > 0 ? Count(n) : "");  // Table 3 prints no counts
    }
    cells.push_back(Ratio(c->Ratio()));
  }
  cells.push_back(absl::StrFormat("%.0f %%", 100 * row.success));
  return cells;
}

nlohmann::json CountsJson(const PaperCounts& counts) {
  return {{"base", counts.base},
          {"ip", counts.ip},
          {"total", counts.Total()},
          {"classical", counts.classical},
          {"ratio", counts.Ratio()}};
}

nlohmann::json RowJson(const PaperRow& row) {
  return {{"label", row.label},
          {"intersect_thousands", CountsJson(row.intersect)},
          {"shade_thousands", CountsJson(row.shade)},
          {"success", row.success}};
}

}  // namespace

std::vector<SequenceSpec> PaperSequences(const std::string& scenes_dir) {
  const std::string face = scenes_dir + "/face.textproto", room = scenes_dir + "/room.textproto";
  return {{"Table 1: face, epsilon 0.25 (caption)", face, 0.25, PrintedFace()},
          {"Table 1: face, epsilon 0.5 (text)", face, 0.5, PrintedFace()},
          {"Table 2: room, epsilon 0.25 (caption)", room, 0.25, PrintedRoom()},
          {"Table 2: room, epsilon 0.1 (text)", room, 0.1, PrintedRoom()}};
}

// Table 3 prints ratios and success only.
std::vector<std::pair<double, PaperRow>> PrintedEpsilonRows() {
  const auto row = [](double intersect, double shade, double success) {
    return PaperRow{"frame1", {0, 0, 0, intersect}, {0, 0, 0, shade}, success};
  };
  return {{1.0, row(0.85, 0.90, 0.90)},
          {0.5, row(1.12, 0.96, 0.78)},
          {0.25, row(1.31, 1.13, 0.76)},
          {0.0, row(3.46, 2.89, 0.0)}};
}

SequenceSpec PaperEpsilonSweep(const std::string& scenes_dir, const PaperRow& printed,
                               double epsilon) {
  return {absl::StrFormat("Table 3: room, first frame, epsilon %.2f", epsilon),
          scenes_dir + "/room.textproto",
          epsilon,
          {printed}};
}

absl::StatusOr<Sequence> MeasureSequence(const SequenceSpec& spec,
                                         const std::vector<std::string>& cameras,
                                         const PaperBenchOptions& options, WorkerPool& pool) {
  auto scene = LoadSceneFile(spec.scene_file);
  if (!scene.ok()) return scene.status();
  SceneHost host(*scene, options.cache);
  Sequence sequence{spec, {}};
  for (const std::string& name : cameras) {
    const Camera* camera = (*scene)->FindCamera(name);
    if (camera == nullptr) {
      return absl::NotFoundError(
          absl::StrCat(spec.scene_file, ": expected a camera named \"", name, "\""));
    }
    FrameRequest request{*camera, options.width, options.height, {}};
    request.options.judge = JudgeKind::kPaper;
    request.options.max_relative_error = spec.epsilon;
    const auto cached = host.RenderFrame(request, pool);
    if (!cached.ok()) return cached.status();
    request.options.mode = Mode::kClassical;
    const auto classical = host.RenderFrame(request, pool);
    if (!classical.ok()) return classical.status();
    sequence.rows.push_back(RowOf(name, *cached, *classical, (*scene)->white, spec.epsilon));
  }
  return sequence;
}

std::string SequenceText(const Sequence& sequence) {
  std::vector<TableColumn> columns{{"", Align::kLeft}};
  for (const char* kind : {" I", " S"}) {
    for (const char* title : {"base", "ip", "total", "classical", "ratio"}) {
      columns.push_back({absl::StrCat(title, kind), Align::kRight});
    }
  }
  columns.push_back({"success", Align::kRight});
  columns.push_back({"beyond", Align::kRight});
  columns.push_back({"max error", Align::kRight});
  Table table(columns);
  for (size_t i = 0; i < sequence.rows.size(); ++i) {
    const MeasuredRow& measured = sequence.rows[i];
    auto cells = Cells(measured.row);
    cells.push_back(Grouped(measured.error.beyond));
    cells.push_back(absl::StrFormat("%.3g", measured.error.max));
    table.AddRow(cells);
    if (i >= sequence.spec.printed.size()) continue;
    auto printed = Cells(sequence.spec.printed[i]);
    printed[0] = "  paper";
    printed.insert(printed.end(), 2, "");
    table.AddRow(printed);
  }
  return absl::StrCat(sequence.spec.title, "\n", table.ToString());
}

nlohmann::json SequenceJson(const Sequence& sequence) {
  nlohmann::json rows = nlohmann::json::array();
  for (size_t i = 0; i < sequence.rows.size(); ++i) {
    const MeasuredRow& measured = sequence.rows[i];
    nlohmann::json row{{"measured", RowJson(measured.row)},
                       {"pixels_beyond_epsilon", measured.error.beyond},
                       {"max_relative_error", measured.error.max},
                       {"cells_tried", measured.stats.cells_tried},
                       {"cells_accepted", measured.stats.cells_accepted},
                       {"cache_bytes", measured.stats.cache_bytes}};
    if (i < sequence.spec.printed.size()) row["printed"] = RowJson(sequence.spec.printed[i]);
    rows.push_back(row);
  }
  return {{"title", sequence.spec.title},
          {"scene", sequence.spec.scene_file},
          {"epsilon", sequence.spec.epsilon},
          {"rows", rows}};
}

}  // namespace linetree
