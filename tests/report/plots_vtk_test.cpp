// SPDX-License-Identifier: BSD-3-Clause
// The SVG of every plot: sound markup, values on their pixels, clips on the plot area. That it also
// looks right is not proven here; the browser test looks at what is painted.
#include <array>
#include <cmath>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/plots/characters.h"
#include "report/plots/plots_module.h"
#include "report/plots/svg.h"
#include "tests/report/markup.h"

namespace plumbline {
namespace {

using test::attributes;
using test::AxisMapping;
using test::numbers;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr double kPixel = 0.11;  // coordinates are written to a tenth of a pixel

Series series(std::vector<double> x, std::vector<double> y) {
  return {"a & b", std::move(x), std::move(y), seriesColour(0), 2, false};
}

PlotFrame unitFrame() {
  PlotFrame frame;
  frame.title = "Title <of> a \"plot\"";
  frame.x = {"x [m]", Range{0, 1}, {}, false, false};
  frame.y = {"y [m]", Range{0, 2}, {}, false, false};
  return frame;
}

HeatMap smallMap() {
  HeatMap map;
  map.frame = unitFrame();
  map.columns = 3;
  map.rows = 2;
  map.values = {0, 1, 2, 3, std::nan(""), 5};
  map.value_label = "n";
  map.cell_labels = {"0", "1", "2", "3", "", "5"};
  return map;
}

/// One of every kind, with values that are not finite where they can occur.
std::map<std::string, std::string> onePlotOfEachKind() {
  const double nan = std::nan("");
  Histogram histogram{unitFrame(), 0, 0.25, {{"n", {1, 2, nan, 1}, seriesColour(0)}}, {}};
  histogram.curves = {series({0, 1}, {1, nan})};
  VectorField field;
  field.frame = unitFrame();
  field.arrows = {{0.5, 0.5, 0.1, 0.2, "note"}, {0.2, 0.2, nan, 0, ""}};
  field.reference = 0.1;
  field.reference_label = "0.1 px";
  return {{"line", toSvg(LinePlot{unitFrame(), {series({0, 0.5, 1}, {0, nan, 2})}}, "line")},
          {"scatter", toSvg(ScatterPlot{unitFrame(), {series({0.1, nan}, {1, 1})}}, "scatter")},
          {"histogram", toSvg(histogram, "histogram")},
          {"map", toSvg(smallMap(), "map")},
          {"field", toSvg(field, "field")},
          {"bars", toSvg(BarPlot{unitFrame(), {"a", "b"}, {"s"}, {{1, nan}}}, "bars")},
          {"boxes", toSvg(BoxPlot{unitFrame(), {{"a", {0, 0.5, 1, 1.5, 2}}}}, "boxes")}};
}

TEST(Plots, AreWellFormedAndFreeOfNumbersThatAreNone) {
  for (const auto& [name, svg] : onePlotOfEachKind()) {
    SCOPED_TRACE(name);
    EXPECT_EQ(test::faultOfXml(svg), "");
    EXPECT_THAT(svg, StartsWith("<svg "));
    EXPECT_THAT(svg, HasSubstr("aria-label=\"Title &lt;of&gt; a &quot;plot&quot;\""));
    EXPECT_THAT(svg, Not(HasSubstr("nan")));
    EXPECT_THAT(svg, Not(HasSubstr("inf")));
    EXPECT_EQ(numbers(attributes(svg, "data-ax").at(0)).size(), 8U);
  }
}

TEST(Plots, NameTheirLogarithmicAxes) {
  LinePlot plot{unitFrame(), {series({0, 1}, {0, 2})}};
  EXPECT_THAT(attributes(toSvg(plot, "plain"), "data-log"), ElementsAre());
  plot.frame.y.log10 = true;
  EXPECT_THAT(attributes(toSvg(plot, "one"), "data-log"), ElementsAre("y"));
  plot.frame.x.log10 = true;
  EXPECT_THAT(attributes(toSvg(plot, "both"), "data-log"), ElementsAre("xy"));
}

// As wide as letters of one byte: what is beside the labels stays where it is.
TEST(Plots, MeasureLettersNotBytes) {
  const auto axes = [](const std::string& label) {
    LinePlot plot{unitFrame(), {series({0, 1}, {0, 2})}};
    plot.frame.y.ticks = {{1, label}};
    return attributes(toSvg(plot, "plot"), "data-ax");
  };
  EXPECT_EQ(axes("10 \u00b5\u00b5\u00b5\u00b5"), axes("10 uuuu"));
  EXPECT_NE(axes("10 uuuu"), axes("10 uuuuuuuu"));
}

TEST(Characters, AreThoseOfUtf8) {
  EXPECT_EQ(internal::characterCount("a\u00b5\u2013"), 3U);
  EXPECT_EQ(internal::lastCharacters("a\u00b5\u2013b", 3), "\u00b5\u2013b");
  EXPECT_EQ(internal::lastCharacters("ab", 3), "ab");
  EXPECT_EQ(internal::lastCharacters("ab", 0), "");
}

// It would be given data that lie otherwise in memory than it takes them to.
TEST(Plots, AreNotDrawnByAModuleOfAnotherBuild) {
  std::string why;
  EXPECT_EQ(internal::drawersOf(PLUMBLINE_FOREIGN_PLOTS, why), nullptr);
  EXPECT_THAT(why, StartsWith(std::string(PLUMBLINE_FOREIGN_PLOTS) + " is of another build"));
  EXPECT_THAT(why, HasSubstr(": 0.0.1 (plots 0123456789ab), the program's is "));
  EXPECT_EQ(internal::drawersOf(PLUMBLINE_FOREIGN_PLOTS "_missing", why), nullptr);
  EXPECT_THAT(why, HasSubstr("No such file"));
  EXPECT_NE(internal::drawersOf("plumbline_plots.so", why), nullptr);
}

TEST(Plots, NeverShareAnId) {
  std::set<std::string> seen;
  for (const auto& [name, svg] : onePlotOfEachKind()) {
    for (const std::string& id : attributes(svg, "id")) {
      EXPECT_THAT(id, StartsWith(name));
      EXPECT_TRUE(seen.insert(id).second) << id;
    }
  }
  EXPECT_GE(seen.size(), 7U);
}

TEST(Plots, AreTheSameBytesForTheSameData) { EXPECT_EQ(onePlotOfEachKind(), onePlotOfEachKind()); }

TEST(Plots, ClipToThePlotArea) {
  for (const auto& [name, svg] : onePlotOfEachKind()) {
    SCOPED_TRACE(name);
    const std::size_t clip = svg.find("<clipPath");
    ASSERT_NE(clip, std::string::npos);
    const std::string rectangle = svg.substr(clip, svg.find("</clipPath>") - clip);
    const AxisMapping axes(svg);
    EXPECT_NEAR(numbers(attributes(rectangle, "x").at(0))[0], axes.a[4], kPixel);
    EXPECT_NEAR(numbers(attributes(rectangle, "y").at(0))[0], axes.a[7], kPixel);
    EXPECT_NEAR(numbers(attributes(rectangle, "width").at(0))[0], axes.a[5] - axes.a[4], kPixel);
    EXPECT_NEAR(numbers(attributes(rectangle, "height").at(0))[0], axes.a[6] - axes.a[7], kPixel);
  }
}

TEST(ScatterPlot, PutsAPointOnItsPixel) {
  const std::string svg = toSvg(ScatterPlot{unitFrame(), {series({0.25}, {1.5})}}, "s");
  const AxisMapping axes(svg);
  EXPECT_THAT(axes.a[0], 0);
  EXPECT_THAT(axes.a[3], 2);
  const std::size_t at = svg.find("class=\"pts\"");
  ASSERT_NE(at, std::string::npos);
  EXPECT_THAT(
      numbers(attributes(svg.substr(at), "d").at(0)),
      ElementsAre(DoubleNear(axes.pixelX(0.25), kPixel), DoubleNear(axes.pixelY(1.5), kPixel)));
}

TEST(ScatterPlot, LeavesOutPointsBeyondTheAxes) {
  const auto svg = toSvg(ScatterPlot{unitFrame(), {series({0.25, 7}, {1.5, 1})}}, "s");
  const std::size_t at = svg.find("class=\"pts\"");
  EXPECT_EQ(numbers(attributes(svg.substr(at), "d").at(0)).size(), 2U);
}

TEST(ScatterPlot, BecomesADensityWhenThereAreManyPoints) {
  ScatterPlot plot{unitFrame(), {series({0.1, 0.2, 0.3}, {1, 1, 1})}};
  plot.max_points = 2;
  const std::string svg = toSvg(plot, "s");
  EXPECT_THAT(svg, HasSubstr("<image "));
  EXPECT_THAT(svg, Not(HasSubstr("class=\"pts\"")));
}

TEST(LinePlot, PutsItsPointsOnTheirPixels) {
  const std::string svg = toSvg(LinePlot{unitFrame(), {series({0, 1}, {0.5, 2})}}, "l");
  const AxisMapping axes(svg);
  const std::size_t clipped = svg.find("<polyline class=\"data\"");
  ASSERT_NE(clipped, std::string::npos);
  EXPECT_THAT(numbers(attributes(svg.substr(clipped), "points").at(0)),
              ElementsAre(DoubleNear(axes.a[4], kPixel), DoubleNear(axes.pixelY(0.5), kPixel),
                          DoubleNear(axes.a[5], kPixel), DoubleNear(axes.a[7], kPixel)));
}

TEST(LinePlot, DrawsABandBetweenItsValuesAndBreaksItWhereOneIsMissing) {
  LinePlot plot{unitFrame(), {}};
  const double nan = std::nan("");
  plot.bands = {{"noise",
                 {0, 0.25, 0.5, 0.75, 1},
                 {0.5, 0.5, nan, 1, 1},
                 {1, 1.5, 1, 1.5, 2},
                 {1, 2, 3, 70}}};
  const std::string svg = toSvg(plot, "b");
  EXPECT_THAT(svg, HasSubstr(">noise</text>"));
  const AxisMapping axes(svg);
  const std::size_t first = svg.find("<polygon class=\"data\"");
  ASSERT_NE(first, std::string::npos);
  const auto near = [](double pixel) { return DoubleNear(pixel, kPixel); };
  EXPECT_THAT(numbers(attributes(svg.substr(first), "points").at(0)),
              ElementsAre(near(axes.pixelX(0)), near(axes.pixelY(1)), near(axes.pixelX(0.25)),
                          near(axes.pixelY(1.5)), near(axes.pixelX(0.25)), near(axes.pixelY(0.5)),
                          near(axes.pixelX(0)), near(axes.pixelY(0.5))));
  const std::size_t second = svg.find("<polygon class=\"data\"", first + 1);
  ASSERT_NE(second, std::string::npos);
  EXPECT_EQ(numbers(attributes(svg.substr(second), "points").at(0)).size(), 8U);
  EXPECT_EQ(svg.find("<polygon class=\"data\"", second + 1), std::string::npos);
}

TEST(LinePlot, KeepsASpikeAmongManyPoints) {
  Series s = series({}, {});
  for (int i = 0; i <= 20000; ++i) {
    s.x.push_back(i / 20000.0);
    s.y.push_back(i == 12345 ? 1.9 : 0.1);
  }
  const std::string svg = toSvg(LinePlot{unitFrame(), {s}}, "l");
  const AxisMapping axes(svg);
  const std::size_t clipped = svg.find("<polyline class=\"data\"");
  const auto points = numbers(attributes(svg.substr(clipped), "points").at(0));
  EXPECT_LT(points.size(), 2U * 4U * 1100U);  // four points of every half pixel at most
  double highest = 1e9;
  for (std::size_t i = 1; i < points.size(); i += 2) highest = std::min(highest, points[i]);
  EXPECT_NEAR(highest, axes.pixelY(1.9), kPixel);
}

TEST(HeatMap, FillsThePlotArea) {
  const std::string svg = toSvg(smallMap(), "m");
  const AxisMapping axes(svg);
  const std::string image = svg.substr(svg.find("<image"));
  EXPECT_NEAR(numbers(attributes(image, "x").at(0))[0], axes.a[4], kPixel);
  EXPECT_NEAR(numbers(attributes(image, "y").at(0))[0], axes.a[7], kPixel);
  EXPECT_NEAR(numbers(attributes(image, "width").at(0))[0], axes.a[5] - axes.a[4], kPixel);
  EXPECT_NEAR(numbers(attributes(image, "height").at(0))[0], axes.a[6] - axes.a[7], kPixel);
}

TEST(VectorField, CountsRowsDownwardsOnAnInvertedAxis) {
  VectorField field;
  field.frame = unitFrame();
  field.frame.y.inverted = true;
  field.arrows = {{0.25, 0.5, 0.1, 0, ""}};
  const std::string svg = toSvg(field, "f");
  const AxisMapping axes(svg);
  EXPECT_EQ(axes.a[3], 0);  // the upper end of the axis is row 0
  const std::size_t clipped = svg.find("<polyline class=\"data\"");
  const auto points = numbers(attributes(svg.substr(clipped), "points").at(0));
  EXPECT_NEAR(points[0], axes.pixelX(0.25), kPixel);
  EXPECT_NEAR(points[1], axes.pixelY(0.5), kPixel);
  EXPECT_LT(points[1], 0.5 * (axes.a[6] + axes.a[7]));  // row 0.5 of 2 lies in the upper half
}

TEST(PlotFrame, GivesBothAxesOneScaleWhenAsked) {
  ScatterPlot plot{unitFrame(), {series({0.25}, {1.5})}};
  plot.frame.equal_axes = true;
  const AxisMapping axes(toSvg(plot, "s"));
  EXPECT_NEAR(axes.a[5] - axes.a[4], (axes.a[6] - axes.a[7]) / 2, 1.0);
}

TEST(Histogram, DrawsABarOverItsBin) {
  const Histogram plot{unitFrame(), 0, 0.25, {{"n", {0, 1.5}, seriesColour(0)}}, {}};
  const std::string svg = toSvg(plot, "h");
  const AxisMapping axes(svg);
  const std::size_t bar = svg.find("<polygon", svg.find("clip-path=\"url(#h-clip"));
  const auto points = numbers(attributes(svg.substr(bar), "points").at(0));
  EXPECT_NEAR(*std::min_element(points.begin(), points.end()),
              std::min(axes.pixelX(0.25), axes.pixelY(1.5)), kPixel);
  EXPECT_THAT(svg, HasSubstr("<title>n; x [m]: 0.25 to 0.5; y [m]: 1.5</title>"));
}

std::string titleOfBar(double first, double bin_width, std::size_t bin, double count = 2) {
  std::vector<double> counts(bin + 1, 0);
  counts[bin] = count;
  const std::string svg =
      toSvg(Histogram{unitFrame(), first, bin_width, {{"n", counts, seriesColour(0)}}, {}}, "h");
  const std::size_t from = svg.find("<title>n; x [m]: ") + 17;
  return svg.substr(from, svg.find("</title>", from) - from);
}

// -5 + 0.2 * 24 + 0.2 is 7e-16.
TEST(Histogram, TellsAnEdgeAtZeroAsZero) {
  EXPECT_EQ(titleOfBar(-5, 0.2, 24), "-0.2 to 0; y [m]: 2");
  EXPECT_EQ(titleOfBar(-5, 0.2, 25), "0 to 0.2; y [m]: 2");
  EXPECT_EQ(titleOfBar(-0.3, 0.1, 2), "-0.1 to 0; y [m]: 2");
}

TEST(Histogram, TellsEdgesByTheWidthOfTheBins) {
  EXPECT_EQ(titleOfBar(-1.2708333, 0.0416666, 0), "-1.2708 to -1.2292; y [m]: 2");
  EXPECT_EQ(titleOfBar(1000, 0.002, 1), "1000.002 to 1000.004; y [m]: 2");
  EXPECT_EQ(titleOfBar(0, 2500, 1), "2500 to 5000; y [m]: 2");
  EXPECT_EQ(titleOfBar(0, 2e-7, 1), "2e-07 to 4e-07; y [m]: 2");
}

TEST(Histogram, TellsACountWithAllItsDigits) {
  EXPECT_EQ(titleOfBar(0, 1, 0, 1234567), "0 to 1; y [m]: 1234567");
}

TEST(BarPlot, TellsWhatABarIsOfWithItsUnit) {
  EXPECT_THAT(toSvg(BarPlot{unitFrame(), {"a", "b"}, {"s"}, {{1, 0.25}}}, "bars"),
              HasSubstr("<title>b, s; y [m]: 0.25</title>"));
}

TEST(BoxPlot, TellsMedianBoxAndWhiskersWithTheirUnit) {
  EXPECT_THAT(toSvg(BoxPlot{unitFrame(), {{"a", {0, 0.5, 1, 1.5, 2}}}}, "boxes"),
              HasSubstr("<title>a; y [m]: median 1, box 0.5 to 1.5, whiskers 0 to 2</title>"));
}

// Scripts of a page know a series by its colour.
TEST(SeriesColour, IsNeverThatOfAnotherSeries) {
  std::set<std::array<int, 3>> seen;
  for (std::size_t i = 0; i < 300; ++i) {
    const Colour c = seriesColour(i);
    EXPECT_TRUE(seen.insert({c.red, c.green, c.blue}).second) << i;
  }
}

TEST(RoundTicks, AreRoundAscendingAndInside) {
  const auto ticks = roundTicks({-0.013, 0.034}, 5);
  ASSERT_GE(ticks.size(), 4U);
  EXPECT_EQ(ticks.front().label, "-0.01");
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    EXPECT_NEAR(ticks[i].position - ticks[i - 1].position, 0.01, 1e-12);
  }
  EXPECT_LE(ticks.back().position, 0.034);
}

}  // namespace
}  // namespace plumbline
