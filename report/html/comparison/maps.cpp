// SPDX-License-Identifier: BSD-3-Clause
// Projection differences and uncertainties over the image.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calibrator/base/statistics.h"
#include "report/html/comparison/sections.h"
#include "report/html/text.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

constexpr int kArrowsAcross = 20;

std::string rangeText(double range_m) {
  return std::isinf(range_m) ? "at infinity" : fmt::format("at {:g} m", range_m);
}

double stepX(const ImageMap& map) { return (map.width - 1.0) / std::max(1, map.columns - 1); }
double stepY(const ImageMap& map) { return (map.height - 1.0) / std::max(1, map.rows - 1); }

PlotFrame mapFrame(const ImageMap& map, const std::string& title, double margin) {
  PlotFrame frame;
  frame.title = title;
  frame.width = 480;
  frame.height = 360;
  const double mx = margin * stepX(map), my = margin * stepY(map);
  frame.x = {"u [px]", Range{-mx, map.width - 1 + mx}, {}, false, false};
  frame.y = {"v [px]", Range{-my, map.height - 1 + my}, {}, true, false};
  frame.equal_axes = true;
  return frame;
}

bool sound(const ImageMap& map) {
  const auto cells = static_cast<std::size_t>(std::max(0, map.columns)) *
                     static_cast<std::size_t>(std::max(0, map.rows));
  return cells > 0 && map.width > 1 && map.height > 1 && map.values.size() == cells;
}

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

Figure heatFigure(const ImageMap& map, const std::string& title, const std::string& label,
                  const std::string& id) {
  HeatMap plot;
  plot.frame = mapFrame(map, title, 0.5);
  plot.columns = map.columns;
  plot.rows = map.rows;
  plot.values = map.values;
  for (double& v : plot.values) {
    if (!std::isfinite(v)) v = std::nan("");
  }
  plot.value_label = label;
  const Summary s = summaryOf(plot.values);
  plot.value_range = Range{0, s.any && s.most > 0 ? s.most : 1};
  std::string caption = s.any
                            ? fmt::format("Median {:.3g} px, largest {:.3g} px.", s.median, s.most)
                            : "Undefined over the whole image.";
  if (s.any && s.undefined > 0) {
    caption += fmt::format(
        " Blank at {:.0f} % of the grid, where a model does not project.",
        100.0 * static_cast<double>(s.undefined) / static_cast<double>(map.values.size()));
  }
  return {toSvg(plot, id), caption, false};
}

double roundedDown(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * power <= value) return factor * power;
  }
  return power;
}

Figure fieldFigure(const ImageMap& map, const std::string& title, const std::string& id) {
  VectorField plot;
  plot.frame = mapFrame(map, title, 0.5);
  plot.colour = seriesColour(0);
  const int stride = std::max(1, map.columns / kArrowsAcross);
  std::vector<double> lengths;
  for (int row = 0; row < map.rows; row += stride) {
    for (int column = 0; column < map.columns; column += stride) {
      const Eigen::Vector2d& d = map.vectors[static_cast<std::size_t>(row * map.columns + column)];
      if (!d.allFinite()) continue;
      lengths.push_back(d.norm());
      plot.arrows.push_back({column * stepX(map), row * stepY(map), d.x(), d.y(),
                             fmt::format("({:.3f}, {:.3f}) px", d.x(), d.y())});
    }
  }
  const double typical = lengths.empty() ? 1 : std::max(1e-9, quantile(lengths, 0.9));
  plot.magnification = 1.2 * stride * stepX(map) / typical;
  plot.reference = roundedDown(typical);
  plot.reference_label = fmt::format("{:g} px", plot.reference);
  return {toSvg(plot, id),
          fmt::format("The difference itself, magnified {:.3g} times.", plot.magnification), false};
}

std::string impliedText(const ImageMap& map) {
  if (!map.implied) return "No alignment of the camera frames was taken out.";
  const Eigen::Vector3d t = 1e3 * map.implied->t;
  return fmt::format(
      "Implied alignment that was taken out: rotation {:.4f}\u00b0, translation ({:.2f}, {:.2f}, "
      "{:.2f}) mm.",
      readable("rad").factor * rotationAngle(map.implied->R), t.x(), t.y(), t.z());
}

std::string methodText(const ImageMap& map) {
  return map.method.empty() ? "" : "Method: " + map.method + ". ";
}

Block differenceBlock(const ImageMap& map, std::size_t index) {
  Block block;
  block.heading = fmt::format("{}: {}, {}", map.camera, map.label, rangeText(map.range_m));
  block.text = methodText(map) + impliedText(map);
  const std::string id = fmt::format("difference-{}", index);
  block.figures.push_back(heatFigure(map, "|d|", "|d| [px]", id));
  if (map.vectors.size() == map.values.size()) {
    block.figures.push_back(fieldFigure(map, "d", id + "-field"));
  }
  return block;
}

}  // namespace

Section differenceSection(const ComparisonRecord& record) {
  Section section{"differences",
                  "Projection differences",
                  "Where the same point falls under two calibrations, after the camera frames are "
                  "aligned as well as one rotation and translation can: what is left is a real "
                  "difference of the lens models, not of their conventions.",
                  {},
                  {}};
  for (std::size_t i = 0; i < record.differences.size(); ++i) {
    if (sound(record.differences[i])) {
      section.blocks.push_back(differenceBlock(record.differences[i], i));
    }
  }
  return section;
}

Section uncertaintySection(const ComparisonRecord& record) {
  Section section{"uncertainties",
                  "Projection uncertainty",
                  fmt::format("Standard deviation of where a point at the stated range falls, from "
                              "the covariance of the calibration under a corner noise of {:g} px. "
                              "It counts noise only: a model that does not fit is not in it.",
                              record.assumptions.pixel_sigma_px),
                  {},
                  {}};
  Block block;
  for (std::size_t i = 0; i < record.uncertainties.size(); ++i) {
    const ImageMap& map = record.uncertainties[i];
    if (!sound(map)) continue;
    Figure figure =
        heatFigure(map, fmt::format("{}, {}, {}", map.label, map.camera, rangeText(map.range_m)),
                   "std [px]", fmt::format("uncertainty-{}", i));
    figure.caption = methodText(map) + figure.caption;
    block.figures.push_back(std::move(figure));
  }
  if (!block.figures.empty()) section.blocks.push_back(std::move(block));
  return section;
}

}  // namespace plumbline::html_internal
