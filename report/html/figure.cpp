// SPDX-License-Identifier: BSD-3-Clause
#include "report/html/figure.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

constexpr double kColoured = 0.98;  // share of the cells below the end of the colours
constexpr double kTypical = 0.9;    // share of the arrows below the typical one
constexpr double kLongest = 2;      // of a typical arrow

double lengthOf(const FieldArrow& arrow) { return std::hypot(arrow.dx, arrow.dy); }

/// To 1, 2 or 5 times a power of ten: a length that a reader takes in.
double roundedDown(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * power <= value) return factor * power;
  }
  return power;
}

}  // namespace

void addFinite(const std::vector<double>& values, std::vector<double>& known) {
  std::ranges::copy_if(values, std::back_inserter(known),
                       [](double v) { return std::isfinite(v); });
}

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
  std::vector<double> known;
  addFinite(plot.values, known);
  if (known.empty()) return {toSvg(plot, id), "Undefined over the whole image."};
  std::string caption = fmt::format(
      "Median {:.3g} px, largest {:.3g} px. Lines of equal value at the ticks of the scale.{}",
      quantile(known, 0.5), *std::ranges::max_element(known), clampText(plot));
  if (known.size() < plot.values.size()) {
    const double undefined = static_cast<double>(plot.values.size() - known.size());
    caption += fmt::format(" Blank at {:.0f} % of the grid, where a model does not project.",
                           100.0 * undefined / static_cast<double>(plot.values.size()));
  }
  return {toSvg(plot, id), caption};
}

// From 0 to a quantile of all maps together: a few wild cells, as at the corners of an image, would
// leave one colour for all others.
void scaleAlike(const std::vector<HeatMap*>& maps) {
  std::vector<double> known;
  for (const HeatMap* map : maps) addFinite(map->values, known);
  // The floor keeps the scale of maps that are all zero from having no length.
  const double end = known.empty() ? 1 : std::max(1e-9, quantile(std::move(known), kColoured));
  for (HeatMap* map : maps) map->value_range = Range{0, end};
}

std::string clampText(const HeatMap& map) {
  double largest = 0;
  for (const double v : map.values) {
    if (std::isfinite(v)) largest = std::max(largest, v);
  }
  if (!map.value_range || largest <= map.value_range->max) return "";
  return fmt::format(" Colours end at {:.2g} px; the largest is {:.2g} px.", map.value_range->max,
                     largest);
}

// One magnification, so that arrows of different fields compare by eye. What is longer than twice a
// typical arrow is cut, lest it lie across its neighbours.
void magnifyAlike(const std::vector<VectorField*>& fields, double reach) {
  std::vector<double> lengths;
  for (const VectorField* field : fields) {
    for (const FieldArrow& arrow : field->arrows) lengths.push_back(lengthOf(arrow));
  }
  // The floor likewise: what follows divides by it.
  const double typical =
      lengths.empty() ? 1 : std::max(1e-9, quantile(std::move(lengths), kTypical));
  for (VectorField* field : fields) {
    field->magnification = reach / typical;
    field->longest = kLongest * typical;
    field->reference = roundedDown(typical);
    field->reference_label = fmt::format("{:g} px", field->reference);
  }
}

std::string cutText(const VectorField& field) {
  const auto cut = std::ranges::count_if(
      field.arrows, [&](const auto& a) { return lengthOf(a) > field.longest; });
  if (field.longest <= 0 || cut == 0) return "";
  return fmt::format(" {} arrow{} above {:.2g} px {} shortened to that length, in red.", cut,
                     cut == 1 ? "" : "s", field.longest, cut == 1 ? "is" : "are");
}

}  // namespace plumbline::html_internal
