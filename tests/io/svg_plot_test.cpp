#include "core/io/svg_plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace linetree {
namespace {

using ::testing::DoubleEq;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pointwise;

// Ticks are multiples of decimal fractions: equal but for rounding.
auto Near(const std::vector<double>& values) { return Pointwise(DoubleEq(), values); }

size_t Count(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(SvgPlot, LinearTicksAreRound) {
  EXPECT_THAT(PlotTicks(0, 1, false), Near({0, 0.2, 0.4, 0.6, 0.8, 1.0}));
  EXPECT_THAT(PlotTicks(3, 48, false), ElementsAre(10, 20, 30, 40));
  EXPECT_THAT(PlotTicks(-5, 5, false), ElementsAre(-4, -2, 0, 2, 4));
}

TEST(SvgPlot, LogarithmicTicksArePowersOfTen) {
  EXPECT_THAT(PlotTicks(1e-4, 1, true), Near({1e-4, 1e-3, 1e-2, 1e-1, 1.0}));
  EXPECT_THAT(PlotTicks(0.9, 30, true), ElementsAre(1, 2, 5, 10, 20));
}

TEST(SvgPlot, ShowsTitleLabelsLegendAndEveryPoint) {
  const Plot plot{"Time", {"epsilon"}, {"ms"}, {{"cold", {{0, 9}, {1, 5}}}, {"warm", {{0, 3}}}}};
  const std::string svg = SvgPlots({plot});
  for (const char* text : {">Time<", ">epsilon<", ">ms<", ">cold<", ">warm<"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
  EXPECT_EQ(Count(svg, "<circle"), 3u);
  EXPECT_EQ(Count(svg, "<polyline"), 2u);
}

TEST(SvgPlot, BandsLieWhereTheirValuesAreAndOnlyOnTheAxis) {
  // The inner rectangle is x 80..590, y 40..285.
  Plot plot{"", {}, {}, {{"a", {{0, 0}, {10, 100}}}}};
  plot.x.max = 10;
  plot.x.bands = {{5, 20, "wide"}, {11, 12, "outside"}};
  plot.y.bands = {{40, 40, "goal"}};
  const std::string svg = SvgPlots({plot});
  EXPECT_THAT(svg, HasSubstr("<rect x=\"335.0\" y=\"40.0\" width=\"255.0\" height=\"245.0\""));
  EXPECT_THAT(svg, HasSubstr("<line x1=\"80.0\" y1=\"187.0\" x2=\"590.0\" y2=\"187.0\""));
  EXPECT_THAT(svg, HasSubstr(">wide<"));
  EXPECT_THAT(svg, HasSubstr(">goal<"));
  EXPECT_THAT(svg, Not(HasSubstr("outside")));
  // A goal that nothing has reached is in the picture too.
  plot.y.bands = {{200, 200, "goal"}};
  EXPECT_THAT(SvgPlots({plot}),
              HasSubstr("<line x1=\"80.0\" y1=\"40.0\" x2=\"590.0\" y2=\"40.0\""));
}

TEST(SvgPlot, PointsLieWhereTheirValuesAre) {
  // The inner rectangle is x 80..590, y 40..285.
  const std::string svg = SvgPlots({{"", {}, {}, {{"a", {{0, 0}, {10, 100}}}}}});
  EXPECT_THAT(svg, HasSubstr("points=\"80.0,285.0 590.0,40.0 \""));
  PlotAxis log_axis;
  log_axis.logarithmic = true;
  const std::string log_svg = SvgPlots({{"", {}, log_axis, {{"a", {{0, 1}, {1, 10}, {2, 100}}}}}});
  EXPECT_THAT(log_svg, HasSubstr("points=\"80.0,285.0 335.0,162.5 590.0,40.0 \""));
}

TEST(SvgPlot, WhatCannotBeDrawnBreaksTheLine) {
  const double inf = std::numeric_limits<double>::infinity();
  PlotAxis log_axis;
  log_axis.logarithmic = true;
  const std::string svg =
      SvgPlots({{"", {}, log_axis, {{"a", {{0, 1}, {1, 0}, {2, 100}, {3, inf}, {4, 10}}}}}});
  EXPECT_EQ(Count(svg, "<circle"), 3u);
  EXPECT_EQ(Count(svg, "<polyline"), 3u);
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST(SvgPlot, EmptyAndFlatDataHaveAxesToo) {
  for (const auto& points : {std::vector<std::pair<double, double>>{},
                             std::vector<std::pair<double, double>>{{2, 0}, {2, 0}}}) {
    const std::string svg = SvgPlots({{"t", {}, {}, {{"a", points}}}});
    EXPECT_THAT(svg, Not(HasSubstr("nan")));
    EXPECT_THAT(svg, Not(HasSubstr("inf")));
    EXPECT_THAT(svg, HasSubstr("</svg>"));
  }
}

TEST(SvgPlot, LongNamesWidenThePicture) {
  const auto with_name = [](const std::string& name) {
    return SvgPlots({{"t", {}, {}, {{name, {{0, 1}, {1, 2}}}}}});
  };
  EXPECT_THAT(with_name("short"), HasSubstr("width=\"760\""));
  EXPECT_THAT(with_name(std::string(40, 'x')), HasSubstr("width=\"910\""));
}

TEST(SvgPlot, TextIsEscaped) {
  EXPECT_THAT(SvgPlots({{"a < b & c", {}, {}, {}}}), HasSubstr("a &lt; b &amp; c"));
}

}  // namespace
}  // namespace linetree
