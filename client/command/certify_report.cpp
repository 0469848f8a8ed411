#include "client/command/certify_report.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/table.h"

namespace linetree {
namespace {

double Share(uint64_t part, uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::string Ratio(double value) { return absl::StrFormat("%.2f", value); }

std::string FamilyName(const CellStudyRow& row) {
  return std::string(kSparseFamilyNames[static_cast<size_t>(row.family)]);
}
std::string EdgeText(const CellStudyRow& row) { return absl::StrFormat("1/%.0f", 1 / row.edge); }

nlohmann::json DoubtsJson(const std::array<uint64_t, kDoubtCount>& doubts) {
  nlohmann::json json = nlohmann::json::object();
  for (size_t d = 1; d < kDoubtCount; ++d) json[std::string(kDoubtNames[d])] = doubts[d];
  return json;
}

// "0.12 (near 0.10, curved 0.02)", a pixel.
std::string UnsummedText(const LightStudyRow& row) {
  uint64_t sum = 0;
  std::string reasons;
  for (size_t i = 0; i < row.unsummed.size(); ++i) {
    if (row.unsummed[i] == 0) continue;
    sum += row.unsummed[i];
    absl::StrAppend(&reasons, reasons.empty() ? "" : ", ", std::string(kUnsummedNames[i]), " ",
                    Ratio(Share(row.unsummed[i], row.covered)));
  }
  const std::string all = Ratio(Share(sum, row.covered));
  return reasons.empty() ? all : absl::StrCat(all, " (", reasons, ")");
}

nlohmann::json UnsummedJson(const LightStudyRow& row) {
  nlohmann::json json = nlohmann::json::object();
  for (size_t i = 0; i < row.unsummed.size(); ++i) {
    json[std::string(kUnsummedNames[i])] = row.unsummed[i];
  }
  return json;
}

}  // namespace

uint64_t CertifyReport::Violations() const {
  uint64_t sum = 0;
  for (const CellStudyRow& row : cells) sum += row.violations + row.replay_differences;
  for (const SceneFrames& scene : frames) {
    for (const FrameStudyRow& row : scene.rows) {
      sum += row.violations + (row.epsilon == 0 ? row.unequal : 0);
    }
  }
  return sum;
}

std::string CellTable(const CertifyReport& report) {
  std::vector<TableColumn> columns = {{"scenes", Align::kLeft},      {"edge", Align::kRight},
                                      {"cells", Align::kRight},      {"isotopic", Align::kRight},
                                      {"same paths", Align::kRight}, {"partly", Align::kRight}};
  for (const double epsilon : report.cell_options.epsilons) {
    columns.push_back({absl::StrFormat("at %.2f", epsilon), Align::kRight});
    columns.push_back({"sampled", Align::kRight});
    columns.push_back({"isotopic", Align::kRight});
    columns.push_back({"paper's", Align::kRight});
  }
  for (const char* title :
       {"rays", "violations", "error/bound", "replay differs", "cell/16 shades", "partly/accepted",
        "refused/accepted", "rays accepted", "rays partly"}) {
    columns.push_back({title, Align::kRight});
  }
  Table table(columns);
  for (const CellStudyRow& row : report.cells) {
    std::vector<std::string> line = {FamilyName(row),
                                     EdgeText(row),
                                     Grouped(row.cells),
                                     Percent(Share(row.isotopic, row.cells)),
                                     Percent(Share(row.same_paths, row.cells)),
                                     Percent(Share(row.partly, row.cells))};
    for (size_t i = 0; i < row.certified.size(); ++i) {
      line.push_back(Percent(Share(row.certified[i], row.cells)));
      line.push_back(Percent(Share(row.sampled[i], row.cells)));
      line.push_back(Percent(Share(row.sampled_isotopic[i], row.cells)));
      line.push_back(Percent(Share(row.paper[i], row.cells)));
    }
    line.push_back(Grouped(row.queries));
    line.push_back(Grouped(row.violations));
    line.push_back(absl::StrFormat("%.3f", row.largest_error));
    line.push_back(Grouped(row.replay_differences));
    line.push_back(Ratio(row.accepted_us / std::max(1e-9, row.shades_us)));
    line.push_back(Ratio(row.partly_us / std::max(1e-9, row.accepted_us)));
    line.push_back(Ratio(row.refused_us / std::max(1e-9, row.accepted_us)));
    line.push_back(Ratio(Share(row.same_path_rays, row.same_paths)));
    line.push_back(Ratio(Share(row.partly_rays, row.partly)));
    table.AddRow(line);
  }
  return table.ToString();
}

std::string DoubtTable(const CertifyReport& report) {
  std::vector<TableColumn> columns = {{"scenes", Align::kLeft}, {"edge", Align::kRight}};
  for (size_t d = 1; d < kDoubtCount; ++d) {
    columns.push_back({std::string(kDoubtNames[d]), Align::kRight});
  }
  for (const double epsilon : report.cell_options.epsilons) {
    columns.push_back({absl::StrFormat("bound > %.2f", epsilon), Align::kRight});
  }
  Table table(columns);
  for (const CellStudyRow& row : report.cells) {
    std::vector<std::string> line = {FamilyName(row), EdgeText(row)};
    for (size_t d = 1; d < kDoubtCount; ++d) {
      line.push_back(absl::StrCat(Percent(Share(row.doubts[d], row.cells)), " (",
                                  Percent(Share(row.isotopic_doubts[d], row.cells)), ")"));
    }
    for (const uint64_t certified : row.certified) {
      line.push_back(Percent(Share(row.same_paths - certified, row.cells)));
    }
    table.AddRow(line);
  }
  return table.ToString();
}

std::string LightTable(const CertifyReport& report) {
  Table table({{"lights", Align::kRight},
               {"functions", Align::kLeft},
               {"covered pixels", Align::kRight},
               {"at most 1 undecided", Align::kRight},
               {"decided a pixel", Align::kRight},
               {"undecided a pixel", Align::kRight},
               {"candidates each", Align::kRight},
               {"answered", Align::kRight},
               {"on, in no sum", Align::kRight},
               {"cells", Align::kRight},
               {"bytes a cell", Align::kRight},
               {"us a cell", Align::kRight}});
  for (const LightStudyRow& row : report.lights) {
    table.AddRow({absl::StrCat(row.lights), row.functions ? "yes" : "no", Grouped(row.covered),
                  Percent(Share(row.nearly_decided, row.covered)),
                  Ratio(Share(row.decided, row.covered)), Ratio(Share(row.undecided, row.covered)),
                  Ratio(Share(row.candidates, row.undecided)),
                  Percent(Share(row.answered, row.candidates)), UnsummedText(row),
                  Grouped(row.cells), absl::StrFormat("%.0f", Share(row.bytes, row.cells)),
                  absl::StrFormat("%.1f", row.cell_us)});
  }
  return table.ToString();
}

std::string FrameTable(const CertifyReport& report) {
  Table table({{"scene", Align::kLeft},
               {"epsilon", Align::kRight},
               {"pixels", Align::kRight},
               {"unequal", Align::kRight},
               {"violations", Align::kRight},
               {"error/allowed", Align::kRight},
               {"interpolated", Align::kRight},
               {"replayed", Align::kRight},
               {"residual", Align::kRight},
               {"searches", Align::kRight},
               {"warm", Align::kRight}});
  for (const SceneFrames& scene : report.frames) {
    for (const FrameStudyRow& row : scene.rows) {
      table.AddRow({scene.scene, Ratio(row.epsilon), Grouped(row.pixels), Grouped(row.unequal),
                    Grouped(row.violations), absl::StrFormat("%.3f", row.largest_error),
                    Percent(Share(row.interpolated, row.pixels)),
                    Percent(Share(row.replayed, row.pixels)),
                    Percent(Share(row.residual, row.pixels)), Ratio(row.path_searches),
                    Ratio(row.warm_searches)});
    }
  }
  return table.ToString();
}

nlohmann::json CertifyJson(const CertifyReport& report) {
  nlohmann::json json = {{"seed", report.cell_options.seed}, {"violations", report.Violations()}};
  for (const CellStudyRow& row : report.cells) {
    json["cells"].push_back({{"scenes", FamilyName(row)},
                             {"edge", row.edge},
                             {"cells", row.cells},
                             {"same_paths", row.same_paths},
                             {"partly", row.partly},
                             {"doubts", DoubtsJson(row.doubts)},
                             {"isotopic", row.isotopic},
                             {"isotopic_doubts", DoubtsJson(row.isotopic_doubts)},
                             {"epsilons", report.cell_options.epsilons},
                             {"certified", row.certified},
                             {"sampled", row.sampled},
                             {"sampled_isotopic", row.sampled_isotopic},
                             {"paper", row.paper},
                             {"rays", row.queries},
                             {"violations", row.violations},
                             {"largest_error_over_bound", row.largest_error},
                             {"replay_differences", row.replay_differences},
                             {"same_path_rays", row.same_path_rays},
                             {"partly_rays", row.partly_rays},
                             {"accepted_us", row.accepted_us},
                             {"partly_us", row.partly_us},
                             {"refused_us", row.refused_us},
                             {"shades_us", row.shades_us}});
  }
  for (const LightStudyRow& row : report.lights) {
    json["lights"].push_back({{"scene", report.lights_scene},
                              {"lights", row.lights},
                              {"functions", row.functions},
                              {"covered_pixels", row.covered},
                              {"at_most_one_undecided", row.nearly_decided},
                              {"decided", row.decided},
                              {"undecided", row.undecided},
                              {"candidates", row.candidates},
                              {"answered_by_functions", row.answered},
                              {"on_in_no_sum", UnsummedJson(row)},
                              {"cells", row.cells},
                              {"bytes", row.bytes},
                              {"cell_us", row.cell_us}});
  }
  for (const SceneFrames& scene : report.frames) {
    for (const FrameStudyRow& row : scene.rows) {
      json["frames"].push_back({{"scene", scene.scene},
                                {"epsilon", row.epsilon},
                                {"pixels", row.pixels},
                                {"unequal", row.unequal},
                                {"violations", row.violations},
                                {"largest_error_over_allowed", row.largest_error},
                                {"interpolated", row.interpolated},
                                {"replayed", row.replayed},
                                {"residual", row.residual},
                                {"path_searches", row.path_searches},
                                {"warm_searches", row.warm_searches}});
    }
  }
  return json;
}

}  // namespace linetree
