// Sections: that promises are kept, in frames and in random scenes, and what editing a scene costs.
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/audit_report.h"
#include "client/command/certify_report.h"
#include "client/command/report_sections.h"
#include "client/command/scene_files.h"
#include "client/command/table.h"
#include "core/audit/audit.h"
#include "core/audit/edit_study.h"
#include "core/audit/frame_study.h"
#include "core/audit/speed_scenes.h"
#include "core/io/load_scene.h"

namespace linetree {
namespace {

using Json = nlohmann::json;

std::string Number(const Json& value) { return absl::StrFormat("%.3g", value.get<double>()); }

absl::StatusOr<Json> RunCertify(const std::vector<std::string>& files,
                                const FrameStudyOptions& options, int threads,
                                const Progress& progress) {
  WorkerPool pool(threads);
  CertifyReport report;
  for (size_t i = 0; i < files.size(); ++i) {
    const auto scene = LoadSceneFile(files[i]);
    if (!scene.ok()) return scene.status();
    const auto part = [&](double share) {
      progress((static_cast<double>(i) + share) / static_cast<double>(files.size()));
    };
    const auto rows =
        StudyFrames(*scene, OrbitOf((*scene)->cameras.at(0), options.frames), options, pool, part);
    if (!rows.ok()) return rows.status();
    report.frames.push_back({std::filesystem::path(files[i]).stem(), *rows});
  }
  return CertifyJson(report);
}

// Of CertifyJson.
std::vector<ReportTable> CertifyTables(const Json& result) {
  ReportTable table{{"scene", "epsilon", "pixels", "unequal", "beyond",
                     "largest error, of what is allowed", "interpolated", "searches, path",
                     "searches, warm"}};
  for (const Json& row : result.at("frames")) {
    const double interpolated = row.at("interpolated").get<double>();
    table.rows.push_back({row.at("scene"), Number(row.at("epsilon")), Grouped(row.at("pixels")),
                          Grouped(row.at("unequal")), Grouped(row.at("violations")),
                          Number(row.at("largest_error_over_allowed")),
                          Percent(interpolated / row.at("pixels").get<double>()),
                          Number(row.at("path_searches")), Number(row.at("warm_searches"))});
  }
  return {table};
}

std::vector<ReportGoal> CertifyGoals(const Json& result) {
  uint64_t beyond = 0, unequal = 0, pixels = 0;
  for (const Json& row : result.at("frames")) {
    pixels += row.at("pixels").get<uint64_t>();
    beyond += row.at("violations").get<uint64_t>();
    if (row.at("epsilon") == 0) unequal += row.at("unequal").get<uint64_t>();
  }
  return {{"pixels beyond epsilon on orbits", "0",
           absl::StrCat(Grouped(beyond), " of ", Grouped(pixels)), beyond == 0},
          {"pixels unequal to classical ones at epsilon 0", "0", Grouped(unequal), unequal == 0}};
}

// Of AuditJson.
std::vector<ReportTable> AuditTables(const Json& result) {
  ReportTable table{{"scenes", "epsilon", "queries", "from cells", "violations",
                     "largest error, of what is allowed"}};
  for (const Json& row : result.at("rows")) {
    table.rows.push_back({row.at("group"), Number(row.at("epsilon")), Grouped(row.at("queries")),
                          Grouped(row.at("from_cells")), Grouped(row.at("violations")),
                          Number(row.at("max_error_over_allowed"))});
  }
  return {table};
}

std::vector<ReportGoal> AuditGoals(const Json& result) {
  uint64_t queries = 0, violations = 0;
  for (const Json& row : result.at("rows")) {
    queries += row.at("queries").get<uint64_t>();
    violations += row.at("violations").get<uint64_t>();
  }
  return {{"answers beyond their promise in random scenes", "0",
           absl::StrCat(Grouped(violations), " of ", Grouped(queries)), violations == 0}};
}

Json SpreadJson(const SpeedSpread& spread) {
  return {{"median", spread.median}, {"least", spread.least}, {"most", spread.most}};
}

std::vector<ReportTable> EditTables(const Json& result) {
  ReportTable table{
      {"objects", "cells", "find the touched, ms", "least", "most", "dropped", "beyond"}};
  for (const Json& row : result.at("rows")) {
    const Json& find = row.at("find_ms");
    table.rows.push_back({Grouped(row.at("objects")), Grouped(row.at("cells")),
                          Number(find.at("median")), Number(find.at("least")),
                          Number(find.at("most")), Percent(row.at("dropped_share").at("median")),
                          Grouped(row.at("beyond"))});
  }
  return {table};
}

std::vector<Plot> EditPlots(const Json& result) {
  const PlotAxis objects{.label = "objects", .logarithmic = true};
  Plot find{
      "finding the cells that a moved sphere touches", objects, {.label = "ms"}, {{"median", {}}}};
  Plot dropped{"cells that are dropped", objects, {.label = "%"}, {{"median", {}}}};
  for (const Json& row : result.at("rows")) {
    const double count = row.at("objects");
    find.series[0].points.emplace_back(count, row.at("find_ms").at("median").get<double>());
    dropped.series[0].points.emplace_back(count,
                                          100 * row.at("dropped_share").at("median").get<double>());
  }
  return {find, dropped};
}

absl::StatusOr<Json> RunEdits(const std::vector<int>& counts, const EditStudyOptions& options,
                              int threads, const Progress& progress) {
  WorkerPool pool(threads);
  Json rows = Json::array();
  for (const int count : counts) {
    const auto part = [&](double share) {
      progress((static_cast<double>(rows.size()) + share) / static_cast<double>(counts.size()));
    };
    const auto study = StudyEdits(MakeSpheres(count, 4), options, pool, part);
    if (!study.ok()) return study.status();
    rows.push_back({{"objects", study->objects},
                    {"cells", study->cells},
                    {"find_ms", SpreadJson(study->find_ms)},
                    {"dropped_share", SpreadJson(study->dropped_share)},
                    {"pixels", study->pixels},
                    {"beyond", study->beyond}});
  }
  return Json{{"rows", std::move(rows)}};
}

std::vector<ReportGoal> EditGoals(const Json& result) {
  uint64_t beyond = 0, pixels = 0;
  for (const Json& row : result.at("rows")) {
    beyond += row.at("beyond").get<uint64_t>();
    pixels += row.at("pixels").get<uint64_t>();
  }
  return {{"pixels beyond epsilon after edits", "0",
           absl::StrCat(Grouped(beyond), " of ", Grouped(pixels)), beyond == 0}};
}

}  // namespace

ReportSection CertifySection(const ReportOptions& options) {
  FrameStudyOptions study;
  study.side = options.quick ? 48 : 256;
  study.frames = options.quick ? 3 : 12;
  auto files = ScenesIn(options.scenes_dir);
  if (files.ok() && options.quick) files->resize(std::min(files->size(), size_t{5}));
  ReportSection section{.id = "certify", .title = "Frames keep their promise"};
  section.text = absl::StrCat(
      "Every pixel of ", study.frames,
      " frames on an orbit of each scene, and of the first view "
      "again, against the classical frame, ",
      study.side, " x ", study.side,
      " pixels, ray by ray; searches of the whole scene are relative to the classical tracer's.");
  section.command = absl::StrCat("linetree bench certify --part frames --size ", study.side,
                                 " --frames ", study.frames);
  section.parameters = {
      {"side", study.side}, {"frames", study.frames}, {"epsilons", study.epsilons}};
  if (files.ok()) {
    for (const std::string& file : *files) section.parameters["scenes"][file] = HashOfFile(file);
    if (options.quick) {
      for (const std::string& file : *files) absl::StrAppend(&section.command, " --scene ", file);
    }
  }
  section.run = [files, study, threads = options.threads](const Progress& progress) {
    return files.ok() ? RunCertify(*files, study, threads, progress)
                      : absl::StatusOr<Json>(files.status());
  };
  section.tables = CertifyTables;
  section.goals = CertifyGoals;
  return section;
}

ReportSection AuditSection(const ReportOptions& options) {
  AuditOptions audit;
  audit.queries = options.quick ? 200'000 : 20'000'000;
  for (int family = 0; family < kSceneFamilies; ++family) {
    audit.families.push_back(static_cast<SceneFamily>(family));
  }
  ReportSection section{.id = "audit", .title = "Answers keep their promise"};
  section.text =
      "Answers of warm caches in random scenes that are made to be hard, asked at random, at "
      "corners "
      "and edges and uphill towards larger errors, against the classical tracer.";
  section.command = absl::StrCat("linetree bench audit --queries ", audit.queries);
  section.parameters = {{"queries", audit.queries}, {"seed", audit.seed}};
  section.run = [audit,
                 threads = options.threads](const Progress& progress) -> absl::StatusOr<Json> {
    WorkerPool pool(threads);
    Answerer answerer;
    const auto report = RunAudit(audit, answerer, pool, progress);
    if (!report.ok()) return report.status();
    return AuditJson(*report, audit);
  };
  section.tables = AuditTables;
  section.goals = AuditGoals;
  return section;
}

ReportSection EditSection(const ReportOptions& options) {
  EditStudyOptions study;
  study.width = study.height = options.quick ? 64 : 512;
  study.edits = options.quick ? 4 : 20;
  study.warm_frames = options.quick ? 3 : 30;
  const std::vector<int> counts =
      options.quick ? std::vector<int>{20, 200} : std::vector<int>{100, 300, 1000, 3000};
  ReportSection section{.id = "edit", .title = "Editing a scene"};
  section.text = absl::StrCat(
      "Spheres are moved one after the other in a scene that has been flown around for ",
      study.warm_frames,
      " frames: how long it takes to find what the change touches, how much of "
      "the cache goes, and whether the frame after it is right.");
  section.command = absl::StrCat("linetree bench edit --made spheres:OBJECTS:4 --width ",
                                 study.width, " --height ", study.height, " --edits ", study.edits,
                                 " --warm ", study.warm_frames);
  section.parameters = {{"side", study.width},
                        {"edits", study.edits},
                        {"warm", study.warm_frames},
                        {"objects", counts},
                        {"epsilon", study.epsilon}};
  section.run = [counts, study, threads = options.threads](const Progress& progress) {
    return RunEdits(counts, study, threads, progress);
  };
  section.plots = EditPlots;
  section.tables = EditTables;
  section.goals = EditGoals;
  return section;
}

}  // namespace linetree
