#include "core/io/svg_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "core/math/check.h"

namespace linetree {
namespace {

// Layout in SVG user units.
constexpr double kWidth = 760;
constexpr double kPlotHeight = 340;
constexpr double kLeft = 80;
constexpr double kRight = 170;  // room for the legend
constexpr double kTop = 40;
constexpr double kBottom = 55;
constexpr double kLegendLine = 18;
constexpr double kLegendLeft = 40;  // from the plot's right edge to its text
constexpr double kLetterWidth = 7;  // at most, on average

// Okabe and Ito's palette: tellable apart by colour-blind readers.
constexpr std::array<const char*, 7> kColors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                "#e69f00", "#56b4e9", "#000000"};

std::string Escaped(const std::string& text) {
  return absl::StrReplaceAll(text, {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}});
}

bool IsDrawable(double value, const PlotAxis& axis) {
  return std::isfinite(value) && (!axis.logarithmic || value > 0);
}

// One axis with its range settled, and where values lie on it.
struct Scale {
  double min, max;
  bool logarithmic;

  // 0 at min, 1 at max.
  double Share(double value) const {
    if (!logarithmic) return (value - min) / (max - min);
    return std::log(value / min) / std::log(max / min);
  }
};

struct Extent {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();
  void Add(double value) {
    min = std::min(min, value);
    max = std::max(max, value);
  }
};

// Widens a range without extent, which no scale can show.
Scale ScaleOf(const PlotAxis& axis, Extent data) {
  if (data.min > data.max) data = axis.logarithmic ? Extent{1, 10} : Extent{0, 1};
  if (!axis.logarithmic && data.min > 0) data.min = 0;
  Scale scale{axis.min.value_or(data.min), axis.max.value_or(data.max), axis.logarithmic};
  if (axis.logarithmic && scale.max <= scale.min) scale.max = scale.min * 10;
  if (!axis.logarithmic && scale.max <= scale.min) scale.max = scale.min + 1;
  return scale;
}

std::pair<Scale, Scale> ScalesOf(const Plot& plot) {
  Extent x, y;
  for (const PlotSeries& series : plot.series) {
    for (const auto& [px, py] : series.points) {
      if (!IsDrawable(px, plot.x) || !IsDrawable(py, plot.y)) continue;
      x.Add(px);
      y.Add(py);
    }
  }
  const auto add_bands = [](const PlotAxis& axis, Extent& extent) {
    for (const PlotBand& band : axis.bands) {
      if (IsDrawable(band.from, axis)) extent.Add(band.from);
      if (IsDrawable(band.to, axis)) extent.Add(band.to);
    }
  };
  add_bands(plot.x, x);
  add_bands(plot.y, y);
  return {ScaleOf(plot.x, x), ScaleOf(plot.y, y)};
}

// Draws one plot whose upper left corner is (0, top).
class PlotDrawing {
 public:
  PlotDrawing(const Plot& plot, double top) : plot_(plot), top_(top + kTop) {
    std::tie(x_, y_) = ScalesOf(plot);
  }

  std::string Draw() {
    for (const PlotBand& band : plot_.x.bands) DrawBand(band, x_, /*upright=*/true);
    for (const PlotBand& band : plot_.y.bands) DrawBand(band, y_, /*upright=*/false);
    DrawAxes();
    for (size_t i = 0; i < plot_.series.size(); ++i) {
      DrawSeries(i);
      DrawLegend(i);
    }
    return std::move(svg_);
  }

 private:
  static constexpr double kInnerWidth = kWidth - kLeft - kRight;
  static constexpr double kInnerHeight = kPlotHeight - kTop - kBottom;

  double X(double value) const { return kLeft + kInnerWidth * x_.Share(value); }
  double Y(double value) const { return top_ + kInnerHeight * (1 - y_.Share(value)); }

  void Text(double x, double y, const char* anchor, const std::string& text,
            const std::string& attributes = "") {
    absl::StrAppendFormat(&svg_, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\"%s>%s</text>\n", x,
                          y, anchor, attributes, Escaped(text));
  }
  void Line(double x1, double y1, double x2, double y2, const char* attributes) {
    absl::StrAppendFormat(&svg_, "<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" %s/>\n", x1,
                          y1, x2, y2, attributes);
  }

  void DrawAxes() {
    constexpr const char* kGrid = "stroke=\"#ddd\"";
    const double bottom = top_ + kInnerHeight;
    for (const double tick : PlotTicks(x_.min, x_.max, x_.logarithmic)) {
      Line(X(tick), top_, X(tick), bottom, kGrid);
      Text(X(tick), bottom + 18, "middle", absl::StrCat(tick));
    }
    for (const double tick : PlotTicks(y_.min, y_.max, y_.logarithmic)) {
      Line(kLeft, Y(tick), kLeft + kInnerWidth, Y(tick), kGrid);
      Text(kLeft - 8, Y(tick) + 4, "end", absl::StrCat(tick));
    }
    absl::StrAppendFormat(
        &svg_,
        "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"none\" "
        "stroke=\"#444\"/>\n",
        kLeft, top_, kInnerWidth, kInnerHeight);
    Text(kLeft + kInnerWidth / 2, top_ - 14, "middle", plot_.title, " font-weight=\"bold\"");
    Text(kLeft + kInnerWidth / 2, bottom + 40, "middle", plot_.x.label);
    const double middle = top_ + kInnerHeight / 2;
    Text(20, middle, "middle", plot_.y.label,
         absl::StrFormat(" transform=\"rotate(-90 20 %.1f)\"", middle));
  }

  // What of it lies on the scale.
  void DrawBand(const PlotBand& band, const Scale& scale, bool upright) {
    const double from = std::max(band.from, scale.min), to = std::min(band.to, scale.max);
    if (from > to) return;
    double left = kLeft, right = kLeft + kInnerWidth;
    double top = top_, bottom = top_ + kInnerHeight;
    if (upright) {
      left = X(from);
      right = X(to);
    } else {
      top = Y(to);
      bottom = Y(from);
    }
    if (from < to) {
      absl::StrAppendFormat(
          &svg_, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"#f3ead3\"/>\n",
          left, top, right - left, bottom - top);
    } else {
      Line(left, top, right, bottom, "stroke=\"#b08030\" stroke-dasharray=\"5 3\"");
    }
    Text(upright ? left + 4 : kLeft + 6, top + (upright ? 14 : -4), "start", band.label,
         " fill=\"#8a6420\" font-size=\"11\"");
  }

  static const char* ColorOf(size_t series) { return kColors[series % kColors.size()]; }
  // Where colours come again, lines are dashed.
  static std::string StrokeOf(size_t series) {
    return absl::StrCat("stroke=\"", ColorOf(series), "\"",
                        series < kColors.size() ? "" : " stroke-dasharray=\"6 3\"");
  }

  void DrawSeries(size_t index) {
    std::string run;
    for (const auto& [x, y] : plot_.series[index].points) {
      if (!IsDrawable(x, plot_.x) || !IsDrawable(y, plot_.y) || !Inside(x, y)) {
        DrawRun(run, index);
        continue;
      }
      absl::StrAppendFormat(&run, "%.1f,%.1f ", X(x), Y(y));
      absl::StrAppendFormat(&svg_, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"2.5\" fill=\"%s\"/>\n",
                            X(x), Y(y), ColorOf(index));
    }
    DrawRun(run, index);
  }

  // Given bounds may be narrower than the data.
  bool Inside(double x, double y) const {
    return x >= x_.min && x <= x_.max && y >= y_.min && y <= y_.max;
  }

  void DrawRun(std::string& run, size_t series) {
    if (run.empty()) return;
    absl::StrAppend(&svg_, "<polyline fill=\"none\" stroke-width=\"1.8\" ", StrokeOf(series),
                    " points=\"", run, "\"/>\n");
    run.clear();
  }

  void DrawLegend(size_t index) {
    const double text = kLeft + kInnerWidth + kLegendLeft, x = text - 26;
    const double y = top_ + 10 + kLegendLine * static_cast<double>(index);
    const std::string stroke = absl::StrCat("stroke-width=\"3\" ", StrokeOf(index));
    Line(x, y, x + 20, y, stroke.c_str());
    Text(text, y + 4, "start", plot_.series[index].name);
  }

  const Plot& plot_;
  double top_;  // of the inner rectangle
  Scale x_{}, y_{};
  std::string svg_;
};

// Wide enough for the longest name of a legend.
double WidthOf(const std::vector<Plot>& plots) {
  size_t longest = 0;
  for (const Plot& plot : plots) {
    for (const PlotSeries& series : plot.series) longest = std::max(longest, series.name.size());
  }
  const double legend = kLegendLeft + kLetterWidth * static_cast<double>(longest);
  return kWidth - kRight + std::max(kRight, legend);
}

std::vector<double> LogarithmicTicks(double min, double max) {
  // A hair wider than the range, so that a power of ten at its end is not lost to rounding.
  const double slack = 1e-9;
  std::vector<double> powers;
  std::vector<double> all;
  const int first = static_cast<int>(std::floor(std::log10(min)));
  const int last = static_cast<int>(std::ceil(std::log10(max)));
  for (int exponent = first; exponent <= last; ++exponent) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double tick = factor * std::pow(10.0, exponent);
      if (tick < min * (1 - slack) || tick > max * (1 + slack)) continue;
      all.push_back(tick);
      if (factor == 1) powers.push_back(tick);
    }
  }
  return powers.size() >= 3 ? powers : all;
}

}  // namespace

std::vector<double> PlotTicks(double min, double max, bool logarithmic, int wanted) {
  LT_CHECK(min < max && wanted >= 1 && (!logarithmic || min > 0));
  if (logarithmic) return LogarithmicTicks(min, max);
  const double rough = (max - min) / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double factor : {5.0, 2.0, 1.0}) {
    if (factor * power >= rough * (1 - 1e-9)) step = factor * power;
  }
  std::vector<double> ticks;
  const double slack = 1e-9 * step;
  for (double k = std::ceil((min - slack) / step); k * step <= max + slack; ++k) {
    // + 0 turns a negative zero into zero.
    ticks.push_back(k * step + 0.0);
  }
  return ticks;
}

std::string SvgPlots(const std::vector<Plot>& plots) {
  const double width = WidthOf(plots);
  const double height = kPlotHeight * static_cast<double>(plots.size());
  std::string svg = absl::StrFormat(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" "
      "viewBox=\"0 0 %.0f %.0f\" font-family=\"sans-serif\" font-size=\"12\">\n"
      "<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
      width, height, width, height);
  for (size_t i = 0; i < plots.size(); ++i) {
    absl::StrAppend(&svg, PlotDrawing(plots[i], kPlotHeight * static_cast<double>(i)).Draw());
  }
  return svg + "</svg>\n";
}

}  // namespace linetree
