// SPDX-License-Identifier: BSD-3-Clause
// Projection differences and uncertainties over the image.
#include <algorithm>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "report/html/comparison/sections.h"
#include "report/html/figure.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

constexpr int kArrowsAcross = 20;
constexpr double kReach = 1.2;  // of a typical arrow, in its cells

/// So that about kArrowsAcross of the grid's points have an arrow across the image.
int strideOf(const ImageMap& map) { return std::max(1, map.columns / kArrowsAcross); }

/// Of every few points of the grid an arrow, in pixels of the image.
VectorField fieldOf(const ImageMap& map, const std::string& title) {
  VectorField plot;
  plot.frame = mapFrame(map, title, 0.5);
  plot.colour = seriesColour(0);
  // Uncertainties have no vectors.
  if (map.vectors.size() != map.values.size()) return plot;
  // Arrows are about as long as they stand apart: at every point of the grid they would be specks.
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
  return {toSvg(plot, id), fmt::format("The difference as a vector, magnified {:.3g} times.{}",
                                       plot.magnification, cutText(plot))};
}

/// A map as plots.
struct DrawnMap {
  const ImageMap* map;
  HeatMap heat;
  VectorField field;
};

/// The maps of one kind, those of points at one range on one scale.
std::vector<DrawnMap> drawn(const std::vector<ImageMap>& all, const std::string& label,
                            bool titled) {
  std::vector<DrawnMap> out;
  for (const ImageMap& map : all) {
    if (!sound(map)) continue;
    const std::string title =
        titled ? fmt::format("{}, {}, {}", map.label, map.camera, rangeText(map.range_m)) : "|d|";
    out.push_back({&map, heatMap(map, title, label), fieldOf(map, "d")});
  }
  std::map<double, std::vector<DrawnMap*>> by_range;
  for (DrawnMap& d : out) by_range[d.map->range_m].push_back(&d);
  // Only maps of one range are compared by their colours and arrows.
  for (const auto& [range, members] : by_range) {
    std::vector<HeatMap*> heat;
    std::vector<VectorField*> fields;
    double reach = 0;
    for (DrawnMap* d : members) {
      heat.push_back(&d->heat);
      fields.push_back(&d->field);
      // By the widest spacing of arrows, as one magnification is that of all.
      reach = std::max(reach, kReach * strideOf(*d->map) * stepX(*d->map));
    }
    scaleAlike(heat);
    magnifyAlike(fields, reach);
  }
  return out;
}

/// What aligned the camera frames, in degrees and millimetres: so much the calibrations differ in
/// where they put the camera, which the maps do not show.
std::string impliedText(const ImageMap& map) {
  if (!map.implied) return "The camera frames were not aligned.";
  const Eigen::Vector3d t = 1e3 * map.implied->t;
  return fmt::format(
      "Alignment of the camera frames that was removed: rotation {:.4f}\u00b0, translation "
      "({:.2f}, {:.2f}, {:.2f}) mm.",
      readable("rad").factor * rotationAngle(map.implied->R), t.x(), t.y(), t.z());
}

std::string methodText(const ImageMap& map) {
  return map.method.empty() ? "" : "Method: " + map.method + ". ";
}

Block differenceBlock(const DrawnMap& drawn, std::size_t i) {
  const ImageMap& map = *drawn.map;
  const std::string id = fmt::format("difference-{}", i);
  Block block{fmt::format("{}: {}, {}", map.camera, map.label, rangeText(map.range_m)),
              methodText(map) + impliedText(map)};
  block.figures.push_back(heatFigure(drawn.heat, id));
  if (!drawn.field.arrows.empty()) {
    block.figures.push_back(fieldFigure(drawn.field, id + "-field"));
  }
  return block;
}

}  // namespace

Section differenceSection(const ComparisonRecord& record) {
  Section section{"differences", "Projection differences",
                  "Difference between the projections of one point under two calibrations, after "
                  "one rotation and translation aligned the camera frames: what remains is a real "
                  "difference of the lens models, not of conventions."};
  for (const DrawnMap& map : drawn(record.differences, "|d| [px]", false)) {
    section.blocks.push_back(differenceBlock(map, section.blocks.size()));
  }
  return section;
}

Section uncertaintySection(const ComparisonRecord& record) {
  Section section{
      "uncertainties", "Projection uncertainty",
      fmt::format("Standard deviation of the projection of a point at the stated range, from the "
                  "covariance of the calibration under a corner noise of {:g} px. It includes "
                  "noise only, not the error of a model that does not fit.",
                  record.assumptions.pixel_sigma_px)};
  std::vector<Figure> figures;
  for (const DrawnMap& map : drawn(record.uncertainties, "std [px]", true)) {
    Figure figure = heatFigure(map.heat, fmt::format("uncertainty-{}", figures.size()));
    figure.caption = methodText(*map.map) + figure.caption;
    figures.push_back(std::move(figure));
  }
  return withFigures(std::move(section), std::move(figures));
}

}  // namespace plumbline::html_internal
