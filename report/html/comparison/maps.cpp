// SPDX-License-Identifier: BSD-3-Clause
// Projection differences and uncertainties over the image.
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/statistics.h"
#include "report/html/compared_plots.h"
#include "report/html/comparison/sections.h"
#include "report/html/text.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

constexpr int kArrowsAcross = 20;
constexpr double kReach = 1.2;  // of a typical arrow, in its cells

std::string rangeText(double range_m) {
  return std::isinf(range_m) ? "at infinity" : fmt::format("at {:g} m", range_m);
}

double stepX(const ImageMap& map) { return (map.width - 1.0) / std::max(1, map.columns - 1); }
double stepY(const ImageMap& map) { return (map.height - 1.0) / std::max(1, map.rows - 1); }

int strideOf(const ImageMap& map) { return std::max(1, map.columns / kArrowsAcross); }

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

HeatMap heatMap(const ImageMap& map, const std::string& title, const std::string& label) {
  HeatMap plot;
  plot.frame = mapFrame(map, title, 0.5);
  plot.columns = map.columns;
  plot.rows = map.rows;
  plot.values = map.values;
  for (double& v : plot.values) {
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
  return {toSvg(plot, id), caption, false};
}

VectorField fieldOf(const ImageMap& map, const std::string& title) {
  VectorField plot;
  plot.frame = mapFrame(map, title, 0.5);
  plot.colour = seriesColour(0);
  if (map.vectors.size() != map.values.size()) return plot;
  const int stride = strideOf(map);
  for (int row = 0; row < map.rows; row += stride) {
    for (int column = 0; column < map.columns; column += stride) {
      const Eigen::Vector2d& d = map.vectors[static_cast<std::size_t>(row * map.columns + column)];
      if (!d.allFinite()) continue;
      plot.arrows.push_back({column * stepX(map), row * stepY(map), d.x(), d.y(),
                             fmt::format("({:.3f}, {:.3f}) px", d.x(), d.y())});
    }
  }
  return plot;
}

Figure fieldFigure(const VectorField& plot, const std::string& id) {
  return {toSvg(plot, id),
          fmt::format("The difference itself, magnified {:.3g} times.{}", plot.magnification,
                      cutText(plot)),
          false};
}

/// The maps of one kind as plots, those of points at one range on one scale.
struct ScaledMaps {
  std::vector<const ImageMap*> maps;
  std::vector<HeatMap> heat;
  std::vector<VectorField> fields;
};

ScaledMaps scaled(const std::vector<ImageMap>& all, const std::string& label, bool titled) {
  ScaledMaps out;
  for (const ImageMap& map : all) {
    if (!sound(map)) continue;
    out.maps.push_back(&map);
    const std::string title =
        titled ? fmt::format("{}, {}, {}", map.label, map.camera, rangeText(map.range_m)) : "|d|";
    out.heat.push_back(heatMap(map, title, label));
    out.fields.push_back(fieldOf(map, "d"));
  }
  std::map<double, std::vector<std::size_t>> by_range;
  for (std::size_t i = 0; i < out.maps.size(); ++i) by_range[out.maps[i]->range_m].push_back(i);
  for (const auto& [range, members] : by_range) {
    std::vector<HeatMap*> heat;
    std::vector<VectorField*> fields;
    double reach = 0;
    for (const std::size_t i : members) {
      heat.push_back(&out.heat[i]);
      fields.push_back(&out.fields[i]);
      reach = std::max(reach, kReach * strideOf(*out.maps[i]) * stepX(*out.maps[i]));
    }
    scaleAlike(heat);
    magnifyAlike(fields, reach);
  }
  return out;
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

Block differenceBlock(const ScaledMaps& scaled, std::size_t i) {
  const ImageMap& map = *scaled.maps[i];
  Block block;
  block.heading = fmt::format("{}: {}, {}", map.camera, map.label, rangeText(map.range_m));
  block.text = methodText(map) + impliedText(map);
  const std::string id = fmt::format("difference-{}", i);
  block.figures.push_back(heatFigure(scaled.heat[i], id));
  if (!scaled.fields[i].arrows.empty()) {
    block.figures.push_back(fieldFigure(scaled.fields[i], id + "-field"));
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
  const ScaledMaps maps = scaled(record.differences, "|d| [px]", false);
  for (std::size_t i = 0; i < maps.maps.size(); ++i) {
    section.blocks.push_back(differenceBlock(maps, i));
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
  const ScaledMaps maps = scaled(record.uncertainties, "std [px]", true);
  for (std::size_t i = 0; i < maps.maps.size(); ++i) {
    Figure figure = heatFigure(maps.heat[i], fmt::format("uncertainty-{}", i));
    figure.caption = methodText(*maps.maps[i]) + figure.caption;
    block.figures.push_back(std::move(figure));
  }
  if (!block.figures.empty()) section.blocks.push_back(std::move(block));
  return section;
}

}  // namespace plumbline::html_internal
