#include "client/command/load_goals.h"

#include <cmath>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "client/command/table.h"

namespace linetree {
namespace {

using Figures = const LoadFigures&;

double Count(uint64_t count) { return static_cast<double>(count); }

double BytesPerFrame(Figures f) {
  return f.frames == 0 ? 0 : Count(f.wire_bytes) / Count(f.frames);
}

std::string Text(double value) { return absl::StrFormat("%.6g", value); }

}  // namespace

const std::vector<LoadMetric>& LoadMetrics() {
  static const std::vector<LoadMetric> metrics = {
      {"frames_per_s", true, [](Figures f) { return f.frames_per_s; }},
      {"p50_ms", false, [](Figures f) { return f.latency.p50; }},
      {"p90_ms", false, [](Figures f) { return f.latency.p90; }},
      {"p99_ms", false, [](Figures f) { return f.latency.p99; }},
      {"max_ms", false, [](Figures f) { return f.latency.max; }},
      {"wait_p99_ms", false, [](Figures f) { return f.wait.p99; }},
      {"queue_p99_ms", false, [](Figures f) { return f.queue.p99; }},
      {"render_p99_ms", false, [](Figures f) { return f.render.p99; }},
      {"encode_p99_ms", false, [](Figures f) { return f.encode.p99; }},
      {"network_p99_ms", false, [](Figures f) { return f.network.p99; }},
      {"light_p99_ms", false, [](Figures f) { return f.light.p99; }},
      {"hit_rate", true, [](Figures f) { return f.sources.HitRate(); }},
      {"refused", false, [](Figures f) { return Count(f.refused); }},
      {"late", false, [](Figures f) { return Count(f.late); }},
      {"not_begun", false, [](Figures f) { return Count(f.not_begun); }},
      {"bytes_per_frame", false, BytesPerFrame},
      {"cells_built", false, [](Figures f) { return Count(f.cells_built); }},
      {"cells_evicted", false, [](Figures f) { return Count(f.cells_evicted); }},
      {"cache_bytes", false, [](Figures f) { return Count(f.cache_bytes); }}};
  return metrics;
}

nlohmann::json MetricsJson(const LoadFigures& figures) {
  nlohmann::json json = nlohmann::json::object();
  for (const LoadMetric& metric : LoadMetrics()) json[metric.name] = metric.value(figures);
  return json;
}

absl::StatusOr<LoadObjective> ParseObjective(const std::string& text) {
  const std::pair<std::string, std::string> parts = absl::StrSplit(text, absl::MaxSplits('=', 1));
  LoadObjective objective;
  if (!absl::SimpleAtod(parts.second, &objective.bound) || !std::isfinite(objective.bound)) {
    return absl::InvalidArgumentError(
        absl::StrCat("expected NAME=NUMBER, such as p99_ms=50, got '", text, "'"));
  }
  for (const LoadMetric& metric : LoadMetrics()) {
    if (metric.name == parts.first) objective.metric = &metric;
  }
  if (objective.metric != nullptr) return objective;
  const auto name = [](std::string* out, const LoadMetric& m) { absl::StrAppend(out, m.name); };
  return absl::InvalidArgumentError(absl::StrCat("no metric '", parts.first, "'; expected one of ",
                                                 absl::StrJoin(LoadMetrics(), ", ", name)));
}

bool IsMet(const LoadObjective& objective, const LoadFigures& figures) {
  const double value = objective.metric->value(figures);
  // Nothing answered is no latency to be proud of.
  if (figures.frames == 0) return false;
  return objective.metric->more_is_better ? value >= objective.bound : value <= objective.bound;
}

std::string ObjectiveTable(const std::vector<LoadObjective>& objectives,
                           const LoadFigures& figures) {
  if (objectives.empty()) return "";
  Table table({{"objective"}, {"wanted", Align::kRight}, {"got", Align::kRight}, {"met"}});
  for (const LoadObjective& objective : objectives) {
    const LoadMetric& metric = *objective.metric;
    table.AddRow({metric.name,
                  absl::StrCat(metric.more_is_better ? ">= " : "<= ", Text(objective.bound)),
                  Text(metric.value(figures)), IsMet(objective, figures) ? "yes" : "NO"});
  }
  return table.ToString();
}

nlohmann::json ObjectivesJson(const std::vector<LoadObjective>& objectives,
                              const LoadFigures& figures) {
  nlohmann::json json = nlohmann::json::array();
  for (const LoadObjective& objective : objectives) {
    json.push_back({{"metric", objective.metric->name},
                    {"bound", objective.bound},
                    {"value", objective.metric->value(figures)},
                    {"met", IsMet(objective, figures)}});
  }
  return json;
}

const char* MetricChange::Judgement() const {
  if (now == before) return "equal";
  return (now > before) == metric->more_is_better ? "better" : "worse";
}

absl::StatusOr<std::vector<MetricChange>> CompareLoads(const nlohmann::json& before,
                                                       const LoadFigures& now) {
  const auto metrics = before.is_object() ? before.find("metrics") : before.end();
  if (metrics == before.end() || !metrics->is_object()) {
    return absl::InvalidArgumentError("metrics: expected what 'load --stats' writes");
  }
  std::vector<MetricChange> changes;
  for (const LoadMetric& metric : LoadMetrics()) {
    const auto found = metrics->find(metric.name);
    if (found == metrics->end()) continue;
    if (!found->is_number()) {
      return absl::InvalidArgumentError(
          absl::StrCat("metrics.", metric.name, ": expected a number, got ", found->dump()));
    }
    changes.push_back({&metric, found->get<double>(), metric.value(now)});
  }
  return changes;
}

std::string ChangeTable(const std::vector<MetricChange>& changes) {
  Table table({{"metric"},
               {"before", Align::kRight},
               {"now", Align::kRight},
               {"difference", Align::kRight},
               {"per cent", Align::kRight},
               {"is"}});
  for (const MetricChange& change : changes) {
    const double difference = change.Difference();
    table.AddRow(
        {change.metric->name, Text(change.before), Text(change.now),
         absl::StrFormat("%+.6g", difference),
         change.before == 0 ? "-" : absl::StrFormat("%+.1f", 100 * difference / change.before),
         change.Judgement()});
  }
  return table.ToString();
}

nlohmann::json ChangesJson(const std::vector<MetricChange>& changes) {
  nlohmann::json json = nlohmann::json::object();
  for (const MetricChange& change : changes) {
    json[change.metric->name] = {{"before", change.before},
                                 {"now", change.now},
                                 {"difference", change.Difference()},
                                 {"is", change.Judgement()}};
  }
  return json;
}

}  // namespace linetree
