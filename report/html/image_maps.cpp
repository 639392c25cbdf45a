// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "report/html/figure.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

/// Of the finite values of a map [px].
struct Summary {
  double median = 0, most = 0;
  std::size_t undefined = 0;
  bool any = false;
};

Summary summaryOf(const std::vector<double>& values) {
  std::vector<double> known;
  for (const double v : values) {
    if (std::isfinite(v)) known.push_back(v);
  }
  if (known.empty()) return {0, 0, values.size(), false};
  return {quantile(known, 0.5), *std::max_element(known.begin(), known.end()),
          values.size() - known.size(), true};
}

}  // namespace

std::string rangeText(double range_m) {
  return std::isinf(range_m) ? "at infinity" : fmt::format("at {:g} m", range_m);
}

// The outermost points lie at the centres of the outermost pixels.
double stepX(const ImageMap& map) { return (map.width - 1.0) / std::max(1, map.columns - 1); }
double stepY(const ImageMap& map) { return (map.height - 1.0) / std::max(1, map.rows - 1); }

bool sound(const ImageMap& map) {
  // A store may state any two numbers: their product need not fit into an int.
  const auto cells = static_cast<std::size_t>(std::max(0, map.columns)) *
                     static_cast<std::size_t>(std::max(0, map.rows));
  return cells > 0 && map.width > 1 && map.height > 1 && map.values.size() == cells;
}

// Axes in pixels of the image, v downwards; `margin` in steps of the grid.
PlotFrame mapFrame(const ImageMap& map, const std::string& title, double margin) {
  const double mx = margin * stepX(map), my = margin * stepY(map);
  return {title,
          {"u [px]", Range{-mx, map.width - 1 + mx}},
          {"v [px]", Range{-my, map.height - 1 + my}, {}, true},
          480,
          360,
          true};
}

HeatMap heatMap(const ImageMap& map, const std::string& title, const std::string& label) {
  HeatMap plot;
  // Cells have the grid's points in their middles: half a step more on every side.
  plot.frame = mapFrame(map, title, 0.5);
  plot.columns = map.columns;
  plot.rows = map.rows;
  plot.values = map.values;
  for (double& v : plot.values) {
    // Infinite values have no colour: blank, as undefined ones.
    if (!std::isfinite(v)) v = std::nan("");
  }
  plot.value_label = label;
  plot.contours = true;
  return plot;
}

Figure heatFigure(const HeatMap& plot, const std::string& id) {
  const Summary s = summaryOf(plot.values);
  std::string caption = s.any
                            ? fmt::format("Median {:.3g} px, largest {:.3g} px.", s.median, s.most)
                            : "Undefined over the whole image.";
  if (s.any) caption += " Lines of equal value at the ticks of the scale." + clampText(plot);
  if (s.any && s.undefined > 0) {
    caption += fmt::format(
        " Blank at {:.0f} % of the grid, where a model does not project.",
        100.0 * static_cast<double>(s.undefined) / static_cast<double>(plot.values.size()));
  }
  return {toSvg(plot, id), caption};
}

}  // namespace plumbline::html_internal
