#include "client/command/budget_run.h"

#include <algorithm>

#include "absl/strings/str_format.h"
#include "client/command/table.h"

namespace linetree {
namespace {

using Json = nlohmann::json;

Json RowOf(const std::string& scene, FlightPattern pattern, Lanes lanes, const BudgetStudy& study) {
  return {{"scene", scene},
          {"flight", kFlightPatternNames[static_cast<size_t>(pattern)]},
          {"lanes", LanesName(lanes)},
          {"working_set_bytes", study.working_set_bytes},
          {"memory_bytes", study.memory_bytes},
          {"average_ratio", study.average_ratio},
          {"median_ratio", study.median_ratio},
          {"least_ratio", study.least_ratio},
          {"cells_built", study.speed.cells_built},
          {"cells_evicted", study.speed.evicted.cells},
          {"pixels", study.speed.pixels},
          {"beyond", study.speed.beyond},
          {"largest_error", study.speed.largest_error}};
}

std::string ByNone(double classical_by_cached) {
  return absl::StrFormat("%.3f", 1 / classical_by_cached);
}

}  // namespace

absl::StatusOr<Json> RunBudgets(const BudgetPlan& plan, const Progress& progress) {
  const PolicyCorpus& corpus = plan.corpus;
  const auto files = ReadCorpusScenes(corpus);
  if (!files.ok()) return files.status();
  WorkerPool pool(corpus.threads);
  BudgetStudyOptions options{.share = plan.share, .frames = {}};
  options.frames.width = corpus.size.width;
  options.frames.height = corpus.size.height;
  options.frames.repeats = plan.repeats;
  options.frames.epsilon = corpus.epsilon;
  Json rows = Json::array();
  const auto count =
      static_cast<double>(files->size() * corpus.patterns.size() * plan.lanes.size());
  for (const SceneFile& file : *files) {
    for (const FlightPattern pattern : corpus.patterns) {
      const auto views = FlightViews(*file.scene, *file.scene->FindCamera(""), pattern,
                                     corpus.frames, corpus.seed);
      for (const Lanes lanes : plan.lanes) {
        options.frames.lanes = lanes;
        const auto study = StudyBudget(file.scene, views, options, pool, [&](double share) {
          progress((static_cast<double>(rows.size()) + share) / count);
        });
        if (!study.ok()) return study.status();
        rows.push_back(RowOf(file.name, pattern, lanes, *study));
      }
    }
  }
  return rows;
}

ReportTable BudgetTable(const Json& rows) {
  ReportTable table{{"scene", "flight", "lanes", "working set", "cache", "all frames", "median",
                     "worst", "cells built", "evicted", "beyond", "largest error"}};
  for (const Json& row : rows) {
    table.rows.push_back({row.at("scene"), row.at("flight"), row.at("lanes"),
                          Bytes(row.at("working_set_bytes")), Bytes(row.at("memory_bytes")),
                          ByNone(row.at("average_ratio")), ByNone(row.at("median_ratio")),
                          ByNone(row.at("least_ratio")), Grouped(row.at("cells_built")),
                          Grouped(row.at("cells_evicted")), Grouped(row.at("beyond")),
                          absl::StrFormat("%.3g", row.at("largest_error").get<double>())});
  }
  return table;
}

std::vector<ReportGoal> BudgetGoals(const Json& rows) {
  double slowest = 0;
  uint64_t met = 0, beyond = 0;
  for (const Json& row : rows) {
    const double by_none = 1 / row.at("average_ratio").get<double>();
    slowest = std::max(slowest, by_none);
    met += by_none <= kMostByNone ? 1 : 0;
    beyond += row.at("beyond").get<uint64_t>();
  }
  return {{"time of a flight's frames with a cache of a small share of the working set, by those "
           "without any",
           absl::StrFormat("at most %.2f in all %d", kMostByNone, rows.size()),
           absl::StrFormat("in %d, at most %.3f", met, slowest), met == rows.size()},
          {"pixels beyond epsilon", "0", Grouped(beyond), beyond == 0}};
}

}  // namespace linetree
