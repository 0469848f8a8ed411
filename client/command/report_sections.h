// All sections of `linetree bench report`, in their order on the page.
#pragma once

#include <vector>

#include "client/command/report_section.h"

namespace linetree {

// Making a section reads what its parameters name, running it is another matter.
struct ReportChapter {
  const char* id;  // of the section that it makes
  ReportSection (*make)(const ReportOptions& options);
};
const std::vector<ReportChapter>& ReportChapters();

// Each in the file of its name: report_error.cpp and so on.
ReportSection ErrorSection(const ReportOptions& options);
ReportSection SweepSection(Sweep sweep, const ReportOptions& options);
ReportSection FramesSection(const ReportOptions& options);
ReportSection MemorySection(const ReportOptions& options);
ReportSection SharingSection(const ReportOptions& options);
ReportSection LoadSection(const ReportOptions& options);
ReportSection CertifySection(const ReportOptions& options);
ReportSection AuditSection(const ReportOptions& options);
ReportSection EditSection(const ReportOptions& options);
ReportSection BudgetSection(const ReportOptions& options);
ReportSection PoliciesSection(const ReportOptions& options);
ReportSection RestartSection(const ReportOptions& options);

}  // namespace linetree
