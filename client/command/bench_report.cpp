// linetree bench report: every claim measured, and one page about it.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/command/command.h"
#include "client/command/flags.h"
#include "client/command/progress_bar.h"
#include "client/command/report_run.h"
#include "client/command/report_sections.h"
#include "client/command/table.h"

namespace linetree {
namespace {

struct BenchReportFlags {
  ReportOptions options;
  std::vector<std::string> sections;  // ids; empty: all
  std::string folder;
  bool fresh = false;
  bool quiet = false;
};

std::vector<std::string> SectionIds() {
  std::vector<std::string> ids;
  for (const ReportChapter& chapter : ReportChapters()) ids.push_back(chapter.id);
  return ids;
}

std::vector<ReportSection> Chosen(const BenchReportFlags& flags) {
  const std::set<std::string> wanted(flags.sections.begin(), flags.sections.end());
  std::vector<ReportSection> sections;
  for (const ReportChapter& chapter : ReportChapters()) {
    if (!wanted.empty() && !wanted.contains(chapter.id)) continue;
    sections.push_back(chapter.make(flags.options));
  }
  return sections;
}

// One bar for each section; without a terminal a line, since it may take hours.
class ReportProgress {
 public:
  explicit ReportProgress(bool quiet) : quiet_(quiet) {}

  void Show(const std::string& title, double share) {
    if (quiet_) return;
    if (title != title_) {
      title_ = title;
      bar_ = std::make_unique<ProgressBar>(IsTerminal(), title);
      if (!IsTerminal()) std::cerr << title << "\n";
    }
    bar_->Show(share);
  }

 private:
  const bool quiet_;
  std::string title_;
  std::unique_ptr<ProgressBar> bar_;
};

bool PrintGoals(const std::vector<ReportEntry>& entries, bool quiet) {
  Table table({{"goal"}, {"wanted", Align::kRight}, {"measured", Align::kRight}, {"met"}});
  bool all_met = true;
  for (const ReportEntry& entry : entries) {
    if (!entry.section.goals) continue;
    for (const ReportGoal& goal : entry.section.goals(entry.result)) {
      table.AddRow({goal.what, goal.wanted, goal.got, goal.met ? "yes" : "NO"});
      all_met = all_met && goal.met;
    }
  }
  if (!quiet) std::cout << table.ToString();
  return all_met;
}

absl::StatusOr<int> BenchReport(const BenchReportFlags& flags) {
  std::error_code error;
  std::filesystem::create_directories(flags.folder, error);
  if (error) {
    return absl::FailedPreconditionError(
        absl::StrCat("-o: ", flags.folder, ": cannot make this folder: ", error.message()));
  }
  absl::StatusOr<std::vector<ReportEntry>> entries;
  {
    ReportProgress bar(flags.quiet);
    entries = RunReport(Chosen(flags), flags.folder, flags.fresh,
                        [&bar](const std::string& title, double share) { bar.Show(title, share); });
  }
  if (!entries.ok()) return entries.status();
  const auto kept = std::count_if(entries->begin(), entries->end(),
                                  [](const ReportEntry& entry) { return !entry.is_new; });
  const bool all_met = PrintGoals(*entries, flags.quiet);
  if (!flags.quiet) {
    std::cout << flags.folder << "/report.html: " << entries->size() << " sections, of which "
              << kept << " were there\n";
  }
  return all_met ? kExitOk : kExitMissed;
}

}  // namespace

void AddBenchReport(CLI::App& bench, Commands& commands) {
  auto flags = std::make_shared<BenchReportFlags>();
  CLI::App* app = bench.add_subcommand("report", "Every claim measured, and one page about it");
  app->add_option("-o,--output", flags->folder,
                  "Folder of report.html and of what each section has found, as JSON; made if it "
                  "is not there")
      ->type_name("DIR")
      ->required();
  app->add_flag("--quick", flags->options.quick, "Small sizes: a minute or two in total");
  app->add_option("--section", flags->sections, "Only these; may be given again")
      ->type_name("ID")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(SectionIds()))
      ->default_str("all: " + absl::StrJoin(SectionIds(), ", "));
  app->add_flag("--fresh", flags->fresh, "Run also what is in DIR already");
  app->add_option("--scenes", flags->options.scenes_dir, "Folder of the scenes")
      ->type_name("DIR")
      ->capture_default_str();
  app->add_option("--threads", flags->options.threads,
                  "Of what is measured with many; 0: all hardware threads")
      ->type_name("N")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  AddQuietFlag(*app, flags->quiet);
  app->footer(
      "A section whose file is in DIR, from the same version of the program and with the same "
      "parameters, is not run again:\nan interrupted report goes on where it was. Each figure "
      "names "
      "its command, machine, date and version.\n"
      "Exit status: 0; 1 on errors; 2 for a wrong command line; 3 when a goal was missed.\n\n"
      "Examples:\n"
      "  linetree bench report --quick -o report\n"
      "  linetree bench report -o report --section error,sharing --fresh");
  commands.push_back({app, [flags] { return BenchReport(*flags); }});
}

}  // namespace linetree
