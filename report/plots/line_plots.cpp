// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "report/plots/internal/chart_page.h"
#include "report/plots/svg.h"
#include "report/plots/ticks.h"

namespace plumbline {
namespace {

using internal::ChartPage;
using internal::LegendEntry;

internal::PageLayout layoutOf(const PlotFrame& frame, const std::vector<Series>& series) {
  internal::PageLayout layout;
  std::vector<const std::vector<double>*> xs, ys;
  for (const Series& s : series) {
    xs.push_back(&s.x);
    ys.push_back(&s.y);
    layout.legend.push_back({s.name, s.colour});
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
      const double v = (y.max - s.y[i]) / (y.max - y.min);
      if (!(u >= 0 && u < 1 && v >= 0 && v < 1)) continue;
      const auto column = static_cast<std::size_t>(u * plot.bins);
      const auto row = static_cast<std::size_t>(v * plot.bins);
      map.values[row * static_cast<std::size_t>(plot.bins) + column] += 1;
    }
  }
  for (double& value : map.values) value = value > 0 ? std::log10(1 + value) : std::nan("");
  return map;
}

}  // namespace

std::string toSvg(const LinePlot& plot, const std::string& id) {
  ChartPage page(plot.frame, layoutOf(plot.frame, plot.series), id);
  for (const Series& series : plot.series) {
    if (series.markers) {
      page.addPoints(series);
    } else {
      page.addLine(series);
    }
  }
  return page.svg();
}

std::string toSvg(const ScatterPlot& plot, const std::string& id) {
  const internal::PageLayout layout = layoutOf(plot.frame, plot.series);
  std::size_t count = 0;
  for (const Series& series : plot.series) count += series.x.size();
  if (count > plot.max_points) return toSvg(density(plot, layout.x, layout.y), id);
  ChartPage page(plot.frame, layout, id);
  for (const Series& series : plot.series) page.addPoints(series);
  return page.svg();
}

}  // namespace plumbline
