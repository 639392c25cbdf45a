// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "report/plots/svg.h"
#include "report/plots/vtk/chart_page.h"

namespace plumbline {
namespace {

using internal::ChartPage;
using internal::SvgDevice;

/// A box between two values of each axis, in units of the data; pen, brush and title are those set.
void drawBox(vtkContext2D& painter, const ChartPage& page, const Range& x, const Range& y) {
  const double u = page.unitX(x.min), v = page.unitY(y.min);
  painter.DrawRect(static_cast<float>(u), static_cast<float>(v),
                   static_cast<float>(page.unitX(x.max) - u),
                   static_cast<float>(page.unitY(y.max) - v));
}

void drawLine(vtkContext2D& painter, const ChartPage& page, const Range& x, const Range& y) {
  painter.DrawLine(static_cast<float>(page.unitX(x.min)), static_cast<float>(page.unitY(y.min)),
                   static_cast<float>(page.unitX(x.max)), static_cast<float>(page.unitY(y.max)));
}

/// From zero, as the length of a bar is what is read; a little air above the highest.
Range heightRange(const std::vector<const std::vector<double>*>& columns) {
  const double top = rangeOf(columns, 0).max;
  return {0, top > 0 ? 1.06 * top : 1};
}

/// To a hundredth of a bin at least, without zeros at the end: first + i w rounds, and the edge at
/// 0 must not read "7e-16".
std::string edgeText(double edge, double bin_width) {
  const double last_digit = std::pow(10.0, std::floor(std::log10(bin_width)) - 2);
  // Adding 0 takes the sign off a rounded -0.
  return fmt::format("{:.15g}", std::round(edge / last_digit) * last_digit + 0.0);
}

void addBars(ChartPage& page, const Histogram& plot, const HistogramSeries& series) {
  page.addDrawing([&page, plot, series](vtkContext2D& painter, SvgDevice& device) {
    internal::setNoPen(painter);
    internal::setBrush(painter, series.colour);
    for (std::size_t i = 0; i < series.counts.size(); ++i) {
      // An empty bin has no bar to point at; nor has one that is not a number.
      if (!(series.counts[i] > 0)) continue;
      const Range bin{plot.edge(i), plot.edge(i + 1)};
      device.setShapeTitle(fmt::format("{}; {}: {} to {}; {}: {}", series.name, plot.frame.x.label,
                                       edgeText(bin.min, plot.bin_width),
                                       edgeText(bin.max, plot.bin_width), plot.frame.y.label,
                                       series.counts[i]));
      drawBox(painter, page, bin, {0, series.counts[i]});
    }
  });
}

/// Of every category, over the series.
std::vector<double> stackedHeights(const BarPlot& plot) {
  std::vector<double> sums(plot.categories.size(), 0);
  for (const auto& values : plot.values) {
    for (std::size_t i = 0; i < std::min(values.size(), sums.size()); ++i) {
      if (std::isfinite(values[i])) sums[i] += values[i];
    }
  }
  return sums;
}

void drawBars(vtkContext2D& painter, SvgDevice& device, const ChartPage& page,
              const BarPlot& plot) {
  const auto side_by_side = static_cast<double>(std::max<std::size_t>(1, plot.values.size()));
  // A group takes 0.8 of its category, a stacked bar a little less.
  const double width = plot.stacked ? 0.7 : 0.8 / side_by_side;
  // Where the next part of a stacked bar begins; of bars side by side it stays 0.
  std::vector<double> floor(plot.categories.size(), 0);
  internal::setNoPen(painter);
  for (std::size_t s = 0; s < plot.values.size(); ++s) {
    internal::setBrush(painter, seriesColour(s));
    for (std::size_t i = 0; i < plot.values[s].size(); ++i) {
      const double value = plot.values[s][i];
      if (!std::isfinite(value)) continue;
      const double from = plot.stacked
                              ? static_cast<double>(i) - width / 2
                              : static_cast<double>(i) - 0.4 + width * static_cast<double>(s);
      device.setShapeTitle(fmt::format("{}, {}; {}: {:.4g}", plot.categories[i], plot.names[s],
                                       plot.frame.y.label, value));
      device.setShapeLink(i < plot.links.size() ? plot.links[i] : "");
      drawBox(painter, page, {from, from + width}, {floor[i], floor[i] + value});
      if (plot.stacked) floor[i] += value;
    }
  }
}

/// A tick below each category, the i-th of which stands at i.
std::vector<AxisTick> ticksOf(const std::vector<std::string>& names) {
  std::vector<AxisTick> ticks;
  for (const std::string& name : names) ticks.push_back({static_cast<double>(ticks.size()), name});
  return ticks;
}

/// A pale version of the colour, opaque so that whiskers do not show through.
Colour tint(const Colour& colour) {
  const auto pale = [](std::uint8_t v) {
    return static_cast<std::uint8_t>(255 - (255 - v) * 23 / 100);
  };
  return {pale(colour.red), pale(colour.green), pale(colour.blue), 255};
}

/// Whiskers, box and median; nothing for a group that is shown by its points.
void drawBoxSummary(vtkContext2D& painter, SvgDevice& device, const ChartPage& page,
                    const BoxSummary& box, const std::string& label, double centre) {
  const auto& q = box.quantiles;
  if (std::isnan(q[2])) return;
  const Colour colour = seriesColour(box.series);
  device.setShapeTitle(
      fmt::format("{}; {}: median {:.4g}, box {:.4g} to {:.4g}, whiskers {:.4g} to {:.4g}",
                  box.name, label, q[2], q[1], q[3], q[0], q[4]));
  internal::setPen(painter, colour, 1.2);
  drawLine(painter, page, {centre, centre}, {q[0], q[1]});
  drawLine(painter, page, {centre, centre}, {q[3], q[4]});
  for (const double end : {q[0], q[4]}) {
    drawLine(painter, page, {centre - 0.12, centre + 0.12}, {end, end});
  }
  // The whiskers come first: box and median lie over them.
  internal::setBrush(painter, tint(colour));
  drawBox(painter, page, {centre - 0.25, centre + 0.25}, {q[1], q[3]});
  internal::setPen(painter, colour, 2.2);
  drawLine(painter, page, {centre - 0.25, centre + 0.25}, {q[2], q[2]});
}

}  // namespace

std::string toSvg(const Histogram& plot, const std::string& id) {
  internal::PageLayout layout;
  std::vector<const std::vector<double>*> heights;
  std::size_t bins = 1;
  for (const HistogramSeries& series : plot.series) {
    heights.push_back(&series.counts);
    bins = std::max(bins, series.counts.size());
    layout.legend.push_back({series.name, series.colour});
  }
  for (const Series& curve : plot.curves) {
    heights.push_back(&curve.y);
    layout.legend.push_back({curve.name, curve.colour});
  }
  layout.x = plot.frame.x.range.value_or(Range{plot.first, plot.edge(bins)});
  layout.y = plot.frame.y.range.value_or(heightRange(heights));
  ChartPage page(plot.frame, layout, id);
  for (const HistogramSeries& series : plot.series) addBars(page, plot, series);
  for (const Series& curve : plot.curves) page.addLine(curve);
  return page.svg();
}

std::string toSvg(const BarPlot& plot, const std::string& id) {
  internal::PageLayout layout;
  std::vector<const std::vector<double>*> heights;
  const std::vector<double> sums = stackedHeights(plot);
  if (plot.stacked) heights.push_back(&sums);
  for (std::size_t s = 0; s < plot.values.size(); ++s) {
    if (!plot.stacked) heights.push_back(&plot.values[s]);
    layout.legend.push_back({plot.names[s], seriesColour(s)});
  }
  layout.x = {-0.5, static_cast<double>(std::max<std::size_t>(1, plot.categories.size())) - 0.5};
  layout.y = plot.frame.y.range.value_or(heightRange(heights));
  PlotFrame frame = plot.frame;
  if (frame.x.ticks.empty()) frame.x.ticks = ticksOf(plot.categories);
  ChartPage page(frame, layout, id);
  page.addDrawing([&page, &plot](vtkContext2D& painter, SvgDevice& device) {
    drawBars(painter, device, page, plot);
  });
  return page.svg();
}

std::string toSvg(const BoxPlot& plot, const std::string& id) {
  std::vector<std::string> names;
  std::vector<double> values;
  for (const BoxSummary& box : plot.boxes) {
    names.push_back(box.name);
    values.insert(values.end(), box.quantiles.begin(), box.quantiles.end());
  }
  // Points may lie beyond the whiskers.
  for (const NamedPoint& point : plot.points) values.push_back(point.y);
  internal::PageLayout layout;
  layout.x = {-0.5, static_cast<double>(std::max<std::size_t>(1, names.size())) - 0.5};
  layout.y = plot.frame.y.range.value_or(rangeOf({&values}, 0.06));
  for (std::size_t s = 0; s < plot.series.size(); ++s) {
    layout.legend.push_back({plot.series[s], seriesColour(s)});
  }
  PlotFrame frame = plot.frame;
  frame.x.ticks = ticksOf(names);
  ChartPage page(frame, layout, id);
  page.addDrawing([&page, &plot](vtkContext2D& painter, SvgDevice& device) {
    for (std::size_t i = 0; i < plot.boxes.size(); ++i) {
      drawBoxSummary(painter, device, page, plot.boxes[i], plot.frame.y.label,
                     static_cast<double>(i));
    }
  });
  page.addNamedPoints(plot.points);
  return page.svg();
}

}  // namespace plumbline
