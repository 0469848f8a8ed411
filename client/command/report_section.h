// A section of `linetree bench report`: one claim, what measures it, and how that is shown.
//
// To add one: a function that makes it, in a file of its own, and a line in ReportChapters().
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "client/command/speed_run.h"
#include "core/io/svg_plot.h"

namespace linetree {

struct ReportOptions {
  bool quick = false;  // small sizes: a minute or two in total
  std::string scenes_dir = "scenes";
  int threads = 0;  // of what is measured with all; 0: all hardware threads
};

struct ReportTable {
  std::vector<std::string> titles{};
  std::vector<std::vector<std::string>> rows{};
};

// What was to be reached.
struct ReportGoal {
  std::string what{};
  std::string wanted{};
  std::string got{};
  bool met = false;
};

// `run` measures; everything else looks at its result only, so that what another run has left in a
// file can be shown as well.
struct ReportSection {
  using Json = nlohmann::json;

  std::string id{};       // of its file and of links to it: [a-z_]+
  std::string title{};    // the claim's subject
  std::string text{};     // what is shown, and how it was measured
  std::string command{};  // that measures the same by hand
  Json parameters{};      // all that the result depends on, but machine and program
  std::function<absl::StatusOr<Json>(const Progress&)> run{};
  std::function<std::vector<Plot>(const Json&)> plots{};
  std::function<std::vector<ReportTable>(const Json&)> tables{};
  std::function<std::vector<ReportGoal>(const Json&)> goals{};  // may be empty
};

}  // namespace linetree
