#include "client/command/error_sweep.h"

#include <algorithm>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_format.h"
#include "core/io/stats_json.h"
#include "core/math/check.h"

namespace linetree {
namespace {

struct Times {
  std::vector<double> classical_ms, cold_ms, warm_ms;
};

absl::StatusOr<Frame> Render(Client& client, const std::string& name, FrameRequest request,
                             Mode mode, double epsilon) {
  request.options.mode = mode;
  request.options.max_relative_error = epsilon;
  return client.RenderFrame(name, request, "", {}, {});
}

// A cold, a warm and a classical frame. Errors of a repetition are those of the others but for what
// thread timing may change, so the worst counts.
absl::Status MeasureOnce(Client& client, const SceneFile& file, const std::string& name,
                         const ErrorSweepOptions& options, Times& times, ErrorSweepRow& row) {
  absl::StatusOr<v1::SceneInfo> loaded = SendScene(client, file, name, /*replace=*/true);
  if (!loaded.ok()) return loaded.status();
  const absl::Cleanup unload = [&] { client.UnloadScene(name).IgnoreError(); };
  const auto cold = Render(client, name, options.request, Mode::kCached, row.epsilon);
  if (!cold.ok()) return cold.status();
  const auto warm = Render(client, name, options.request, Mode::kCached, row.epsilon);
  if (!warm.ok()) return warm.status();
  const auto classical = Render(client, name, options.request, Mode::kClassical, row.epsilon);
  if (!classical.ok()) return classical.status();

  times.cold_ms.push_back(cold->stats.wall_ms);
  times.warm_ms.push_back(warm->stats.wall_ms);
  times.classical_ms.push_back(classical->stats.wall_ms);
  row.cold_success = HitRate(cold->stats);
  row.warm_success = HitRate(warm->stats);
  const CompareOptions compare{.white = classical->white, .max_relative_error = row.epsilon};
  for (const auto& [frame, worst] : {std::pair(&*cold, &row.cold), {&*warm, &row.warm}}) {
    const ErrorFigures figures = CompareRadiance(frame->radiance, classical->radiance, compare);
    if (worst->pixels == 0 || figures.max > worst->max) *worst = figures;
  }
  return absl::OkStatus();
}

PlotSeries SeriesOf(const std::string& name, const std::vector<ErrorSweepRow>& rows,
                    const std::function<double(const ErrorSweepRow&)>& value) {
  PlotSeries series{name, {}};
  for (const ErrorSweepRow& row : rows) series.points.emplace_back(row.epsilon, value(row));
  return series;
}

}  // namespace

double Median(std::vector<double> values) {
  LT_CHECK(!values.empty());
  std::sort(values.begin(), values.end());
  const size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

absl::StatusOr<std::vector<ErrorSweepRow>> SweepErrors(
    Client& client, const SceneFile& file, const std::string& name,
    const ErrorSweepOptions& options, const std::function<void(double)>& progress) {
  LT_CHECK(options.repeats >= 1);
  std::vector<ErrorSweepRow> rows;
  for (const double epsilon : options.epsilons) {
    ErrorSweepRow row{.epsilon = epsilon};
    Times times;
    for (int i = 0; i < options.repeats; ++i) {
      absl::Status status = MeasureOnce(client, file, name, options, times, row);
      if (!status.ok()) return status;
      const double done = static_cast<double>(rows.size()) + (i + 1.0) / options.repeats;
      if (progress) progress(done / static_cast<double>(options.epsilons.size()));
    }
    row.classical_ms = Median(times.classical_ms);
    row.cold_ms = Median(times.cold_ms);
    row.warm_ms = Median(times.warm_ms);
    rows.push_back(row);
  }
  return rows;
}

std::string ErrorSweepCsv(const std::vector<ErrorSweepRow>& rows) {
  std::string csv =
      "epsilon,classical_ms,cold_ms,warm_ms,cold_success,warm_success,pixels,"
      "cold_max_error,cold_p999_error,cold_mean_error,cold_beyond,"
      "warm_max_error,warm_p999_error,warm_mean_error,warm_beyond\n";
  for (const ErrorSweepRow& row : rows) {
    absl::StrAppendFormat(&csv, "%.6g,%.3f,%.3f,%.3f,%.6f,%.6f,%d", row.epsilon, row.classical_ms,
                          row.cold_ms, row.warm_ms, row.cold_success, row.warm_success,
                          row.cold.pixels);
    for (const ErrorFigures& figures : {row.cold, row.warm}) {
      absl::StrAppendFormat(&csv, ",%.6g,%.6g,%.6g,%d", figures.max, figures.p999, figures.mean,
                            figures.beyond);
    }
    csv += "\n";
  }
  return csv;
}

std::vector<Plot> ErrorSweepPlots(const std::vector<ErrorSweepRow>& rows,
                                  const std::string& title) {
  using Row = const ErrorSweepRow&;
  const PlotAxis epsilon{.label = "epsilon"};
  const PlotAxis percent{.label = "hit rate, %", .min = 0, .max = 100};
  const PlotAxis error{.label = "relative error", .logarithmic = true};
  return {{title + ": run time",
           epsilon,
           {.label = "ms"},
           {SeriesOf("cold", rows, [](Row r) { return r.cold_ms; }),
            SeriesOf("warm", rows, [](Row r) { return r.warm_ms; }),
            SeriesOf("classical", rows, [](Row r) { return r.classical_ms; })}},
          {title + ": success of interpolation",
           epsilon,
           percent,
           {SeriesOf("cold", rows, [](Row r) { return 100 * r.cold_success; }),
            SeriesOf("warm", rows, [](Row r) { return 100 * r.warm_success; })}},
          {title + ": error of warm frames",
           epsilon,
           error,
           {SeriesOf("max", rows, [](Row r) { return r.warm.max; }),
            SeriesOf("99.9 percentile", rows, [](Row r) { return r.warm.p999; }),
            SeriesOf("mean", rows, [](Row r) { return r.warm.mean; }),
            SeriesOf("promise", rows, [](Row r) { return r.epsilon; })}}};
}

}  // namespace linetree
