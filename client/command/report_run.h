// Runs the sections of a report one after the other and keeps what each has found, so that a report
// that was interrupted goes on where it was.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/command/provenance.h"
#include "client/command/report_section.h"

namespace linetree {

// A section that has been measured, now or by an earlier run.
struct ReportEntry {
  ReportSection section;
  nlohmann::json result;
  Provenance provenance;
  bool is_new = false;
};

// Fills `folder` with ID.json for each section and report.html, which is written anew after each.
// A section whose file is there, whole, with the same parameters, by the same version of this
// program, is not run again, unless `fresh`. `progress` gets the section's title and how much of
// all is done. Errors name the section; what was found before stays.
absl::StatusOr<std::vector<ReportEntry>> RunReport(
    const std::vector<ReportSection>& sections, const std::string& folder, bool fresh,
    const std::function<void(const std::string&, double)>& progress);

// The whole page: goals first, then the sections.
std::string ReportHtml(const std::vector<ReportEntry>& entries);

}  // namespace linetree
