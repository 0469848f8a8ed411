#include "client/command/report_run.h"

#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/command/output.h"
#include "core/io/atomic_file.h"
#include "core/io/html_page.h"
#include "core/io/read_file.h"

namespace linetree {
namespace {

constexpr uint64_t kMaxFileBytes = uint64_t{256} << 20;

using Json = nlohmann::json;

std::string FileOf(const std::string& folder, const ReportSection& section) {
  return absl::StrCat(folder, "/", section.id, ".json");
}

// Whether the section can show it.
bool CanShow(const ReportSection& section, const Json& result) {
  try {
    if (section.plots) section.plots(result);
    if (section.tables) section.tables(result);
    if (section.goals) section.goals(result);
    return true;
  } catch (const Json::exception&) {
    return false;
  }
}

// What an earlier run has left, if that is what this one would find. A file that is anything else
// is as good as none.
std::optional<ReportEntry> ReadEntry(const std::string& folder, const ReportSection& section) {
  const auto text = ReadFileAtMost(FileOf(folder, section), kMaxFileBytes);
  if (!text.ok()) return std::nullopt;
  const Json json = Json::parse(*text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || !json.contains("result")) return std::nullopt;
  const auto provenance = ProvenanceFromJson(json.value("provenance", Json()));
  if (!provenance || provenance->version != ProvenanceOf(section.command).version) {
    return std::nullopt;
  }
  if (json.value("parameters", Json()) != section.parameters) return std::nullopt;
  if (!CanShow(section, json["result"])) return std::nullopt;
  return ReportEntry{section, json["result"], *provenance, /*is_new=*/false};
}

absl::StatusOr<ReportEntry> Measure(const std::string& folder, const ReportSection& section,
                                    const Progress& progress) {
  absl::StatusOr<Json> result = section.run(progress);
  if (!result.ok()) {
    return absl::Status(result.status().code(),
                        absl::StrCat(section.id, ": ", result.status().message()));
  }
  const Provenance provenance = ProvenanceOf(section.command);
  const Json json = {{"section", section.id},
                     {"parameters", section.parameters},
                     {"provenance", ProvenanceJson(provenance)},
                     {"result", *result}};
  if (auto s = WriteJson(json, FileOf(folder, section)); !s.ok()) return s;
  return ReportEntry{section, *std::move(result), provenance, /*is_new=*/true};
}

void AddGoals(const std::vector<ReportEntry>& entries, HtmlPage& page) {
  std::vector<std::vector<std::string>> rows;
  for (const ReportEntry& entry : entries) {
    if (!entry.section.goals) continue;
    for (const ReportGoal& goal : entry.section.goals(entry.result)) {
      rows.push_back({goal.what, goal.wanted, goal.got, goal.met ? "yes" : "NO"});
    }
  }
  if (rows.empty()) return;
  page.Heading("What was to be reached", "goals");
  page.Table({"goal", "wanted", "measured", "met"}, rows);
}

}  // namespace

absl::StatusOr<std::vector<ReportEntry>> RunReport(
    const std::vector<ReportSection>& sections, const std::string& folder, bool fresh,
    const std::function<void(const std::string&, double)>& progress) {
  std::vector<ReportEntry> entries;
  for (const ReportSection& section : sections) {
    const double done = static_cast<double>(entries.size());
    const auto show = [&](double share) {
      if (progress) progress(section.title, (done + share) / static_cast<double>(sections.size()));
    };
    show(0);
    auto kept = fresh ? std::nullopt : ReadEntry(folder, section);
    if (kept) {
      entries.push_back(*std::move(kept));
    } else {
      auto entry = Measure(folder, section, show);
      if (!entry.ok()) return entry.status();
      entries.push_back(*std::move(entry));
    }
    auto status = WriteFileAtomically(absl::StrCat(folder, "/report.html"), ReportHtml(entries));
    if (!status.ok()) return status;
  }
  return entries;
}

std::string ReportHtml(const std::vector<ReportEntry>& entries) {
  HtmlPage page("Linetree: what the system does");
  page.Paragraph(
      "Every figure names the command that measures it, the machine, the date and the version of "
      "the program. Counts do not depend on the machine; times do.");
  AddGoals(entries, page);
  for (const ReportEntry& entry : entries) {
    const ReportSection& section = entry.section;
    page.Heading(section.title, section.id);
    page.Paragraph(section.text);
    const std::string caption = entry.provenance.ToString();
    if (section.plots) {
      for (const Plot& plot : section.plots(entry.result)) page.Figure(SvgPlots({plot}), caption);
    }
    if (!section.tables) continue;
    for (const ReportTable& table : section.tables(entry.result)) {
      page.Table(table.titles, table.rows);
      page.Paragraph(caption);
    }
  }
  return page.ToString();
}

}  // namespace linetree
