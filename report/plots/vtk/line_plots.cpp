// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "report/plots/svg.h"
#include "report/plots/vtk/chart_page.h"

namespace plumbline {
namespace {

using internal::ChartPage;
using internal::LegendEntry;

/// Axes from lines and bands where the frame gives none; named points do not count.
internal::PageLayout layoutOf(const PlotFrame& frame, const std::vector<Series>& series,
                              const std::vector<ColouredLine>& coloured = {},
                              const std::vector<Band>& bands = {}) {
  internal::PageLayout layout;
  std::vector<const std::vector<double>*> xs, ys;
  for (const Series& s : series) {
    xs.push_back(&s.x);
    ys.push_back(&s.y);
    layout.legend.push_back({s.name, s.colour});
  }
  for (const ColouredLine& line : coloured) {
    xs.push_back(&line.x);
    ys.push_back(&line.y);
  }
  for (const Band& band : bands) {
    xs.push_back(&band.x);
    ys.push_back(&band.low);
    ys.push_back(&band.high);
    layout.legend.push_back({band.name, band.colour});
  }
  layout.x = frame.x.range.value_or(rangeOf(xs, 0.02));
  layout.y = frame.y.range.value_or(rangeOf(ys, 0.06));
  return layout;
}

/// Counts of the points in bins x bins cells over the axes; empty cells are NaN.
HeatMap density(const ScatterPlot& plot, const Range& x, const Range& y) {
  HeatMap map;
  map.frame = plot.frame;
  map.frame.x.range = x;
  map.frame.y.range = y;
  map.columns = map.rows = plot.bins;
  map.value_label = "log10(1 + " + plot.count_label + ")";
  map.values.assign(static_cast<std::size_t>(plot.bins) * static_cast<std::size_t>(plot.bins), 0);
  for (const Series& s : plot.series) {
    for (std::size_t i = 0; i < s.x.size(); ++i) {
      const double u = (s.x[i] - x.min) / (x.max - x.min);
      // A map's rows begin at the top.
      const double v = (y.max - s.y[i]) / (y.max - y.min);
      if (!(u >= 0 && u < 1 && v >= 0 && v < 1)) continue;
      const auto column = static_cast<std::size_t>(u * plot.bins);
      const auto row = static_cast<std::size_t>(v * plot.bins);
      map.values[row * static_cast<std::size_t>(plot.bins) + column] += 1;
    }
  }
  // By the logarithm, so that single points are seen beside a core of thousands; empty cells stay
  // blank.
  for (double& value : map.values) value = value > 0 ? std::log10(1 + value) : std::nan("");
  return map;
}

// A path of thousands of pieces becomes that many series at most.
constexpr int kColourClasses = 24;

/// By the mean of the values at both ends; -1 for a piece without a value, which is not drawn.
int classOf(const ColouredLine& line, std::size_t i, const Range& range) {
  const double middle = (line.value[i] + line.value[i + 1]) / 2;
  if (!std::isfinite(middle)) return -1;
  const double unit = std::clamp((middle - range.min) / (range.max - range.min), 0.0, 1.0);
  return std::min(static_cast<int>(unit * kColourClasses), kColourClasses - 1);
}

/// The line as one series per class of colour, with gaps between its pieces.
std::vector<Series> classesOf(const ColouredLine& line, const Range& range) {
  std::vector<Series> classes(kColourClasses);
  std::vector<std::size_t> last(kColourClasses, line.x.size());
  for (int k = 0; k < kColourClasses; ++k) {
    classes[static_cast<std::size_t>(k)].colour = internal::errorColour((k + 0.5) / kColourClasses);
    classes[static_cast<std::size_t>(k)].width = line.width;
  }
  for (std::size_t i = 0; i + 1 < line.x.size(); ++i) {
    const int which = classOf(line, i, range);
    if (which < 0) continue;
    const auto k = static_cast<std::size_t>(which);
    // The class's last piece ended elsewhere: a gap, and the start of this one.
    if (last[k] != i) {
      for (auto* column : {&classes[k].x, &classes[k].y}) column->push_back(std::nan(""));
      classes[k].x.push_back(line.x[i]);
      classes[k].y.push_back(line.y[i]);
    }
    classes[k].x.push_back(line.x[i + 1]);
    classes[k].y.push_back(line.y[i + 1]);
    last[k] = i + 1;
  }
  return classes;
}

}  // namespace

std::string toSvg(const LinePlot& plot, const std::string& id) {
  internal::PageLayout layout = layoutOf(plot.frame, plot.series, plot.coloured, plot.bands);
  layout.colour_bar = !plot.coloured.empty();
  ChartPage page(plot.frame, layout, id);
  for (const Band& band : plot.bands) page.addBand(band);
  for (const Series& series : plot.series) {
    if (series.markers) {
      page.addPoints(series);
    } else {
      page.addLine(series);
    }
  }
  for (const ColouredLine& line : plot.coloured) {
    for (const Series& piece : classesOf(line, plot.value_range)) {
      if (!piece.x.empty()) page.addLine(piece);
    }
  }
  if (layout.colour_bar) {
    page.addColourBar(plot.value_range, plot.value_label, &internal::errorColour);
  }
  page.addNamedPoints(plot.points);
  return page.svg();
}

std::string toSvg(const ScatterPlot& plot, const std::string& id) {
  const internal::PageLayout layout = layoutOf(plot.frame, plot.series);
  std::size_t count = 0;
  for (const Series& series : plot.series) count += series.x.size();
  // The path of so many points would make the page large, and the cloud one blot.
  if (count > plot.max_points) return toSvg(density(plot, layout.x, layout.y), id);
  ChartPage page(plot.frame, layout, id);
  for (const Series& series : plot.series) page.addPoints(series);
  return page.svg();
}

}  // namespace plumbline
