#include "client/command/report_sections.h"

namespace linetree {
namespace {

template <Sweep sweep>
ReportSection SweepOver(const ReportOptions& options) {
  return SweepSection(sweep, options);
}

}  // namespace

const std::vector<ReportChapter>& ReportChapters() {
  static const std::vector<ReportChapter> chapters = {{"error", ErrorSection},
                                                      {"lights", SweepOver<Sweep::kLights>},
                                                      {"objects", SweepOver<Sweep::kObjects>},
                                                      {"depth", SweepOver<Sweep::kDepth>},
                                                      {"resolution", SweepOver<Sweep::kResolution>},
                                                      {"samples", SweepOver<Sweep::kSamples>},
                                                      {"frames", FramesSection},
                                                      {"memory", MemorySection},
                                                      {"sharing", SharingSection},
                                                      {"load", LoadSection},
                                                      {"certify", CertifySection},
                                                      {"audit", AuditSection},
                                                      {"edit", EditSection},
                                                      {"policies", PoliciesSection},
                                                      {"budget", BudgetSection},
                                                      {"restart", RestartSection}};
  return chapters;
}

}  // namespace linetree
