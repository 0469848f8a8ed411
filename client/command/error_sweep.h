// Time, success and error of cached frames over a range of epsilons.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/command/session.h"
#include "core/io/compare.h"
#include "core/io/svg_plot.h"

namespace linetree {

// One epsilon. Times are medians of what the renderer itself measured, in the same process and
// in turn; cold is the first frame of an empty cache, warm the next one.
struct ErrorSweepRow {
  double epsilon = 0;
  double classical_ms = 0;
  double cold_ms = 0;
  double warm_ms = 0;
  double cold_success = 0;  // hit rates
  double warm_success = 0;
  ErrorFigures cold{};  // against the classical frame
  ErrorFigures warm{};
};

struct ErrorSweepOptions {
  FrameRequest request;  // its epsilon and mode are replaced
  std::vector<double> epsilons;
  int repeats = 3;
};

// `file` is loaded afresh under `name` for every cold frame, and unloaded at the end.
absl::StatusOr<std::vector<ErrorSweepRow>> SweepErrors(Client& client, const SceneFile& file,
                                                       const std::string& name,
                                                       const ErrorSweepOptions& options,
                                                       const std::function<void(double)>& progress);

double Median(std::vector<double> values);  // of at least one

std::string ErrorSweepCsv(const std::vector<ErrorSweepRow>& rows);
// Run time, success and error over epsilon.
std::vector<Plot> ErrorSweepPlots(const std::vector<ErrorSweepRow>& rows, const std::string& title);

}  // namespace linetree
