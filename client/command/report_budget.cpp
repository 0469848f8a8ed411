// Section: a cache that is far too small, against none.
#include "absl/strings/str_cat.h"
#include "client/command/budget_run.h"
#include "client/command/report_sections.h"
#include "client/command/scene_files.h"

namespace linetree {
namespace {

using Json = nlohmann::json;

}  // namespace

ReportSection BudgetSection(const ReportOptions& options) {
  BudgetPlan plan;
  plan.corpus.scenes = CorpusScenes(options.scenes_dir);
  plan.corpus.patterns = AllFlightPatterns();
  plan.corpus.frames = options.quick ? 8 : 40;
  plan.corpus.size.width = plan.corpus.size.height = options.quick ? 64 : 256;
  plan.corpus.threads = 1;
  plan.repeats = options.quick ? 1 : 3;
  if (options.quick) plan.corpus.scenes.resize(1);
  ReportSection section{.id = "budget", .title = "A cache that is far too small"};
  section.text = absl::StrCat(
      "A flight with a large cache tells the working set; then frames of a cache that may hold ",
      100 * plan.share,
      " % of it and classical ones in turn, one thread. Times are those with the cache by those "
      "without.");
  section.command = absl::StrCat("linetree bench budget --frames ", plan.corpus.frames, " --width ",
                                 plan.corpus.size.width, " --height ", plan.corpus.size.height,
                                 " --repeat ", plan.repeats);
  section.parameters = {{"frames", plan.corpus.frames},
                        {"side", plan.corpus.size.width},
                        {"share", plan.share},
                        {"repeats", plan.repeats}};
  for (const std::string& file : plan.corpus.scenes) {
    section.parameters["files"][file] = HashOfFile(file);
  }
  section.run = [plan](const Progress& progress) -> absl::StatusOr<Json> {
    auto rows = RunBudgets(plan, progress);
    if (!rows.ok()) return rows.status();
    return Json{{"rows", *std::move(rows)}};
  };
  section.plots = [](const Json&) { return std::vector<Plot>(); };
  section.tables = [](const Json& result) { return std::vector{BudgetTable(result.at("rows"))}; };
  section.goals = [](const Json& result) { return BudgetGoals(result.at("rows")); };
  return section;
}

}  // namespace linetree
