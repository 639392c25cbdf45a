// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace plumbline {

/// sRGB with opacity; 0 to 255 each.
struct Colour {
  std::uint8_t red = 0, green = 0, blue = 0, alpha = 255;
  bool operator==(const Colour&) const = default;
};

/// Of what failed or goes beyond its bound.
inline constexpr Colour kWarningColour{192, 32, 40, 255};

/// The i-th of seven colours that stay apart for colour-blind readers (after Okabe and Ito); from
/// the eighth on duller ones of the same hues.
Colour seriesColour(std::size_t i);

struct Range {
  double min = 0;
  double max = 1;
  bool operator==(const Range&) const = default;
};

struct AxisTick {
  double position = 0;
  std::string label;
};

/// One axis: what it measures with its unit ("e_u [px]"), and what it shows.
struct PlotAxis {
  std::string label;
  std::optional<Range> range = {};   ///< empty: from the data, with a margin
  std::vector<AxisTick> ticks = {};  ///< empty: round numbers
  bool inverted = false;             ///< values grow downwards, as image rows do (y axis only)
  bool upright_labels = false;       ///< tick labels turned by 90 degrees (x axis only)
  bool log10 = false;  ///< positions are log10 of the values, which the page's scripts tell
  /// Points above this position have no value, and the page's scripts tell none (y axis only).
  std::optional<double> highest = {};
};

/// What all plots share.
struct PlotFrame {
  std::string title;
  PlotAxis x, y;
  int width = 560;  ///< of the whole figure [CSS px]
  int height = 340;
  bool equal_axes = false;  ///< one unit has the same length on both axes
};

/// Points of one name and colour; x and y have the same length. Points that are not finite are
/// left out (a line breaks there).
struct Series {
  std::string name;  ///< shown in the legend unless empty
  std::vector<double> x, y;
  Colour colour;
  double width = 1.4;    ///< of a line, or diameter of a marker [px]
  bool dashed = false;   ///< lines only
  bool markers = false;  ///< LinePlot: points instead of a line
};

/// What lies between two values at each x; all three have the same length. It breaks where a value
/// is not finite.
struct Band {
  std::string name;  ///< shown in the legend unless empty
  std::vector<double> x, low, high;
  Colour colour;
};

/// A line whose colour tells a value at each of its points: green, amber, red.
struct ColouredLine {
  std::vector<double> x, y, value;
  double width = 2;  ///< [px]
};

/// A value that has a name and may lead somewhere.
struct NamedPoint {
  double x = 0, y = 0;
  std::string title;  ///< shown when pointed at
  std::string link;   ///< relative address; empty: none
  Colour colour;
};

struct LinePlot {
  PlotFrame frame;
  std::vector<Series> series;
  std::vector<ColouredLine> coloured = {};  ///< above the series, with a colour bar
  std::string value_label = {};             ///< of the colour bar, with unit
  Range value_range = {};                   ///< of the colours; values beyond have the end's
  std::vector<NamedPoint> points = {};      ///< above the lines
  std::vector<Band> bands = {};             ///< below the lines
};

/// A cloud of points; above `max_points` in all it is drawn as a density of `bins` x `bins` cells
/// coloured by log10(1 + count). Points outside the axes are not drawn.
struct ScatterPlot {
  PlotFrame frame;
  std::vector<Series> series;
  std::size_t max_points = 50'000;
  int bins = 120;
  std::string count_label = "points";  ///< what the density counts
};

/// Counts over equal bins; bin i covers [first + i w, first + (i + 1) w].
struct HistogramSeries {
  std::string name;
  std::vector<double> counts;
  Colour colour;
};

struct Histogram {
  PlotFrame frame;
  double first = 0;
  double bin_width = 1;
  std::vector<HistogramSeries> series;  ///< drawn over each other, later ones on top
  std::vector<Series> curves;           ///< e.g. the normal density that was assumed

  /// Where bin i begins and the one before it ends.
  double edge(std::size_t i) const { return first + bin_width * static_cast<double>(i); }
};

enum class ColourMap {
  kSequential,  ///< dark to bright (cividis), for counts and magnitudes
  kDiverging,   ///< blue, white, red; for signed values, symmetric about 0
};

/// A matrix of cells, row-major from the top row down; NaN: nothing there, left blank.
struct HeatMap {
  PlotFrame frame;  ///< axis ranges are those of the cells' outer edges and must be given
  int columns = 0;
  int rows = 0;
  std::vector<double> values;
  std::string value_label;  ///< of the colour bar, with unit
  std::optional<Range> value_range;
  ColourMap colours = ColourMap::kSequential;
  std::vector<std::string> cell_labels;  ///< as `values`, where they fit; empty: none
  bool contours = false;                 ///< lines of equal value at the colour bar's ticks
};

struct FieldArrow {
  double x = 0, y = 0;    ///< foot, in the axes' units
  double dx = 0, dy = 0;  ///< vector, in its own unit
  std::string note;       ///< shown when pointed at
};

struct VectorField {
  PlotFrame frame;
  std::vector<FieldArrow> arrows;
  double magnification = 1;     ///< length on the axes per unit of a vector
  double longest = 0;           ///< an arrow is cut to this, and marked [vectors' unit]; 0: none is
  double reference = 0;         ///< length of the arrow in the key, in vectors' unit; 0: no key
  std::string reference_label;  ///< "0.5 px"
  Colour colour;
};

/// Groups of bars side by side, or of one bar in parts: values[series][category].
struct BarPlot {
  PlotFrame frame;  ///< the x axis' ticks are made from the categories, if none are given
  std::vector<std::string> categories;
  std::vector<std::string> names;
  std::vector<std::vector<double>> values;
  bool stacked = false;                 ///< on each other; what is not finite counts as 0
  std::vector<std::string> links = {};  ///< of the categories; empty: none
};

/// Minimum, quartiles, maximum.
struct BoxSummary {
  std::string name;
  /// 0, 25, 50, 75, 100 % (or the whiskers' own); NaN: no box, only its name and place.
  std::array<double, 5> quantiles{};
  std::size_t series = 0;  ///< decides the colour; place in BoxPlot::series
};

struct BoxPlot {
  PlotFrame frame;  ///< the x axis' ticks are made from the names
  std::vector<BoxSummary> boxes;
  std::vector<std::string> series = {};  ///< names for the legend; empty: none
  std::vector<NamedPoint> points = {};   ///< above the boxes; the i-th box stands at x = i
};

}  // namespace plumbline
