#include "client/command/audit_report.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/table.h"
#include "core/io/stats_json.h"

namespace linetree {
namespace {

double Share(uint64_t part, uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

// The cells of a row that every kind of row has.
std::vector<std::string> TallyCells(const AuditTally& tally) {
  return {Grouped(tally.queries),
          Grouped(tally.hits),
          Percent(Share(tally.from_cells, tally.hits)),
          Percent(Share(tally.listed_shadow_rays, tally.shadow_rays)),
          Percent(Share(tally.equal, tally.queries)),
          Grouped(tally.violations),
          absl::StrFormat("%.3g", tally.max_error_over_allowed)};
}

std::vector<TableColumn> Columns(std::vector<TableColumn> columns) {
  for (const char* title : {"queries", "not background", "from cells", "listed shadow rays",
                            "equal", "violations", "largest error/allowed"}) {
    columns.push_back({title, Align::kRight});
  }
  return columns;
}

std::string RowsText(const AuditReport& report) {
  Table table(Columns({{"scenes of"}, {"epsilon", Align::kRight}, {"scenes", Align::kRight}}));
  const auto add = [&table](std::vector<std::string> cells, const AuditTally& tally) {
    for (std::string& cell : TallyCells(tally)) cells.push_back(std::move(cell));
    table.AddRow(std::move(cells));
  };
  for (const AuditRow& row : report.rows) {
    add({row.group, absl::StrFormat("%g", row.epsilon), Grouped(row.scenes)}, row.tally);
  }
  add({"all", "", Grouped(report.scenes)}, report.total);
  return table.ToString();
}

std::string KindsText(const AuditReport& report) {
  Table table(Columns({{"queries by"}}));
  for (size_t k = 0; k < kQueryKinds; ++k) {
    std::vector<std::string> cells = {std::string(kQueryKindNames[k])};
    for (std::string& cell : TallyCells(report.by_kind[k])) cells.push_back(std::move(cell));
    table.AddRow(std::move(cells));
  }
  return table.ToString();
}

nlohmann::json TallyJson(const AuditTally& tally) {
  return {{"queries", tally.queries},
          {"not_background", tally.hits},
          {"from_cells", tally.from_cells},
          {"shadow_rays", tally.shadow_rays},
          {"listed_shadow_rays", tally.listed_shadow_rays},
          {"equal", tally.equal},
          {"violations", tally.violations},
          {"max_error_over_allowed", JsonNumber(tally.max_error_over_allowed)}};
}

nlohmann::json ViolationJson(const Violation& violation) {
  const auto hex = [](const Rgb& rgb) { return HexText(Vec3d{rgb.r, rgb.g, rgb.b}); };
  return {{"scene", violation.scene},
          {"origin", HexText(violation.ray.origin)},
          {"direction", HexText(violation.ray.direction)},
          {"epsilon", violation.options.max_relative_error},
          {"max_depth", violation.options.limits.max_depth},
          {"min_weight", violation.options.limits.min_weight},
          {"asked_as", violation.from_frame ? "pixel" : "ray"},
          {"answer", hex(violation.answer)},
          {"classical", hex(violation.classical)},
          {"error_over_allowed", JsonNumber(violation.error_over_allowed)}};
}

}  // namespace

std::string AuditText(const AuditReport& report) {
  std::string text = absl::StrCat(RowsText(report), "\n", KindsText(report), "\n");
  absl::StrAppendFormat(&text, "%s violations in %s queries, %.1f s\n",
                        Grouped(report.total.violations), Grouped(report.total.queries),
                        report.wall_s);
  for (const Violation& violation : report.violations) {
    absl::StrAppend(&text, ToLine(violation), "\n");
  }
  return text;
}

nlohmann::json AuditJson(const AuditReport& report, const AuditOptions& options) {
  nlohmann::json json = {{"seed", options.seed},
                         {"judge", options.judge == JudgeKind::kCertified ? "certified" : "paper"},
                         {"scenes", report.scenes},
                         {"wall_s", report.wall_s},
                         {"total", TallyJson(report.total)},
                         {"rows", nlohmann::json::array()},
                         {"kinds", nlohmann::json::object()},
                         {"violations", nlohmann::json::array()}};
  for (const AuditRow& row : report.rows) {
    nlohmann::json entry = TallyJson(row.tally);
    entry["group"] = row.group;
    entry["epsilon"] = row.epsilon;
    entry["scenes"] = row.scenes;
    json["rows"].push_back(std::move(entry));
  }
  for (size_t k = 0; k < kQueryKinds; ++k) {
    json["kinds"][std::string(kQueryKindNames[k])] = TallyJson(report.by_kind[k]);
  }
  for (const Violation& violation : report.violations) {
    json["violations"].push_back(ViolationJson(violation));
  }
  return json;
}

}  // namespace linetree
