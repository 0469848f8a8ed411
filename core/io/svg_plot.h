// Line charts as SVG.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace linetree {

// A range of an axis that is marked for reference, right across the plot; a line where it has no
// extent.
struct PlotBand {
  double from = 0;
  double to = 0;
  std::string label{};
};

struct PlotAxis {
  std::string label{};
  bool logarithmic = false;
  // Where not given, the axis spans the data and its bands; a linear axis of data that is nowhere
  // negative starts at 0.
  std::optional<double> min{};
  std::optional<double> max{};
  std::vector<PlotBand> bands{};
};

struct PlotSeries {
  std::string name;
  std::vector<std::pair<double, double>> points;  // in the order in which they are joined
};

struct Plot {
  std::string title;
  PlotAxis x;
  PlotAxis y;
  std::vector<PlotSeries> series;
};

// One SVG document with the plots one below the other: grid, ticks, labels, a legend each. Points
// that are not finite, or not positive on a logarithmic axis, are left out and break the line.
std::string SvgPlots(const std::vector<Plot>& plots);

// Values to mark on an axis from min to max, in increasing order, all inside: on a linear axis
// multiples of 1, 2 or 5 times a power of ten, about `wanted` of them; on a logarithmic one powers
// of ten, and 2 and 5 times them where there are fewer than three powers. Requires min < max, and
// min > 0 on a logarithmic axis.
std::vector<double> PlotTicks(double min, double max, bool logarithmic, int wanted = 6);

}  // namespace linetree
