// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "report/html/calibration/sections.h"
#include "report/html/figure.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

constexpr int kFieldColumns = 20;   // cells across the image for the vector field
constexpr double kReach = 1.1;      // of a typical arrow, in its cells
constexpr int kMapColumns = 24;     // and for the RMSE and coverage maps
constexpr std::size_t kFewest = 8;  // corners that make a cell's mean; a caption says so
// By a quantile: one false corner would leave the cloud a dot in the middle.
constexpr double kShown = 0.999;  // share of the errors inside the scatter's axes

/// Sums of the errors that fell into each cell of a grid over the image, row by row.
struct ImageGrid {
  int columns = 0, rows = 0;
  double cell_width = 0, cell_height = 0;  // [px]
  std::vector<std::size_t> count;
  std::vector<Eigen::Vector2d> sum;
  std::vector<double> squares;
};

enum class Corners { kUsed, kAll };

/// Errors are measured minus projected; cells are about square.
ImageGrid binErrors(const StageView& stage, int camera, int columns, Corners which) {
  const Resolution size = stage.cameras[static_cast<std::size_t>(camera)].intrinsics.resolution;
  ImageGrid grid;
  const double width = std::max(1, size.width), height = std::max(1, size.height);
  // Rows that make the cells about square.
  grid.columns = columns;
  grid.rows = std::max(1, static_cast<int>(std::lround(columns * height / width)));
  grid.cell_width = width / grid.columns;
  grid.cell_height = height / grid.rows;
  const auto cells = static_cast<std::size_t>(grid.columns * grid.rows);
  grid.count.assign(cells, 0);
  grid.sum.assign(cells, Eigen::Vector2d::Zero());
  grid.squares.assign(cells, 0);
  for (const CornerResidual& r : stage.residuals) {
    if (r.camera != camera || (!r.used && which == Corners::kUsed)) continue;
    // The image begins half a pixel before the centre of its first one.
    const double u = (static_cast<double>(r.uv.x()) + 0.5) / grid.cell_width;
    const double v = (static_cast<double>(r.uv.y()) + 0.5) / grid.cell_height;
    const int column = std::clamp(static_cast<int>(u), 0, grid.columns - 1);
    const int row = std::clamp(static_cast<int>(v), 0, grid.rows - 1);
    const auto cell = static_cast<std::size_t>(row * grid.columns + column);
    grid.count[cell] += 1;
    grid.sum[cell] += r.error.cast<double>();
    grid.squares[cell] += static_cast<double>(r.error.squaredNorm());
  }
  return grid;
}

/// The whole image, whose outer edge is half a pixel beyond the centres of its first and last ones;
/// v downwards.
PlotFrame imageFrame(const std::string& title, const Resolution& size) {
  return {title,
          {"u [px]", Range{-0.5, size.width - 0.5}},
          {"v [px]", Range{-0.5, size.height - 0.5}, {}, true},
          470,
          320,
          true};
}

/// Measured minus projected [px], of the corners that the solution used.
std::vector<Eigen::Vector2d> usedErrors(const StageView& stage, int camera) {
  std::vector<Eigen::Vector2d> errors;
  for (const CornerResidual& r : stage.residuals) {
    if (r.camera == camera && r.used) errors.push_back(r.error.cast<double>());
  }
  return errors;
}

/// Half of the width that holds kShown of the errors along either axis, rounded up a little.
double shownRange(const std::vector<Eigen::Vector2d>& errors) {
  std::vector<double> largest;
  largest.reserve(errors.size());
  for (const auto& e : errors) largest.push_back(e.cwiseAbs().maxCoeff());
  return largest.empty() ? 1.0 : std::max(1e-6, 1.15 * quantile(std::move(largest), kShown));
}

Figure scatterFigure(const std::vector<Eigen::Vector2d>& errors, const std::string& name,
                     const std::string& id) {
  const double range = shownRange(errors);
  ScatterPlot plot;
  const Range shown_errors{-range, range};
  plot.frame = {
      name + ": errors", {"e_u [px]", shown_errors}, {"e_v [px]", shown_errors}, 440, 400, true};
  plot.count_label = "corners";
  Series series{"", {}, {}, {0, 94, 162, 110}, 2};
  std::size_t outside = 0;
  for (const auto& e : errors) {
    series.x.push_back(e.x());
    series.y.push_back(e.y());
    if (e.cwiseAbs().maxCoeff() > range) ++outside;
  }
  plot.series = {std::move(series)};
  const std::string left_out =
      outside == 0
          ? ""
          : fmt::format(" {} outside the axes.",
                        outside == 1 ? "1 corner lies" : fmt::format("{} corners lie", outside));
  // As toSvg() chooses between points and density.
  const std::string shown = errors.size() > plot.max_points ? "the density of all used corners"
                                                            : "one point per used corner";
  return {toSvg(plot, id),
          "Measured minus projected, " + shown +
              ". A round cloud centred on zero is noise; an elongated or shifted one indicates "
              "blur, rolling shutter or a model that does not fit." +
              left_out};
}

Figure histogramFigure(const std::vector<Eigen::Vector2d>& errors, const std::string& name,
                       const std::string& id) {
  // Odd, so that one bin is centred on 0.
  constexpr int kBins = 61;
  const double range = shownRange(errors);
  Histogram plot;
  plot.frame = {name + ": distribution", {"error component [px]"}, {"corners"}, 440, 400};
  plot.first = -range;
  plot.bin_width = 2 * range / kBins;
  plot.series = {{"e_u", std::vector<double>(kBins, 0), {0, 94, 162, 150}},
                 {"e_v", std::vector<double>(kBins, 0), {213, 94, 0, 110}}};
  double squares = 0;
  for (const auto& e : errors) {
    squares += e.squaredNorm();
    for (int axis : {0, 1}) {
      const double place = (e[axis] + range) / plot.bin_width;
      if (!(place >= 0 && place < kBins)) continue;
      plot.series[static_cast<std::size_t>(axis)].counts[static_cast<std::size_t>(place)] += 1;
    }
  }
  const auto n = static_cast<double>(errors.size());
  // Of a component: every corner has two.
  const double deviation = std::max(1e-9, std::sqrt(squares / std::max(1.0, 2 * n)));
  plot.curves = {normalCurve("normal, same RMS", deviation, range, n * plot.bin_width)};
  return {toSvg(plot, id),
          fmt::format("Components of the error, with a normal density of the same RMS ({:.3f} px). "
                      "A sharper peak with long tails indicates outliers: use a robust loss.",
                      deviation)};
}

VectorField errorField(const StageView& stage, int camera, const std::string& name) {
  const ImageGrid grid = binErrors(stage, camera, kFieldColumns, Corners::kUsed);
  VectorField plot;
  plot.frame = imageFrame(name + ": mean error over the image",
                          stage.cameras[static_cast<std::size_t>(camera)].intrinsics.resolution);
  plot.colour = seriesColour(0);
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const auto cell = static_cast<std::size_t>(row * grid.columns + column);
      if (grid.count[cell] < kFewest) continue;
      const Eigen::Vector2d mean = grid.sum[cell] / static_cast<double>(grid.count[cell]);
      // The middle of the cell; pixel 0 has its centre at 0.
      plot.arrows.push_back(
          {(column + 0.5) * grid.cell_width - 0.5, (row + 0.5) * grid.cell_height - 0.5, mean.x(),
           mean.y(),
           fmt::format("({:.3f}, {:.3f}) px of {} corners", mean.x(), mean.y(), grid.count[cell])});
    }
  }
  return plot;
}

Figure fieldFigure(const VectorField& plot, const std::string& id) {
  return {
      toSvg(plot, id),
      fmt::format("Mean error of the corners in each cell, magnified {:.0f} times, on one scale "
                  "for all cameras. Arrows in all directions are noise; a pattern (radial, "
                  "swirling, one-sided) is a distortion that the model does not describe.{}",
                  plot.magnification, cutText(plot))};
}

HeatMap imageMap(const StageView& stage, int camera, const ImageGrid& grid,
                 const std::string& title) {
  HeatMap map;
  map.frame =
      imageFrame(title, stage.cameras[static_cast<std::size_t>(camera)].intrinsics.resolution);
  map.columns = grid.columns;
  map.rows = grid.rows;
  return map;
}

HeatMap errorMap(const StageView& stage, int camera, const std::string& name) {
  const ImageGrid grid = binErrors(stage, camera, kMapColumns, Corners::kUsed);
  HeatMap map = imageMap(stage, camera, grid, name + ": RMSE by region");
  map.value_label = "RMSE [px]";
  map.contours = true;
  for (std::size_t i = 0; i < grid.count.size(); ++i) {
    const bool enough = grid.count[i] >= kFewest;
    // A few corners tell nothing of their region.
    map.values.push_back(enough ? std::sqrt(grid.squares[i] / static_cast<double>(grid.count[i]))
                                : std::nan(""));
  }
  return map;
}

Figure regionFigure(const HeatMap& map, const std::string& id) {
  return {toSvg(map, id),
          "RMSE of the used corners by region, on one scale for all cameras; blank where there are "
          "fewer than eight. Uniform is good; bright corners of the image mean that the distortion "
          "model does not fit there. Lines of equal value at the ticks of the scale." +
              clampText(map)};
}

/// A camera without a name goes by its place.
std::string cameraName(const StageView& stage, std::size_t camera) {
  const std::string& name = stage.cameras[camera].name;
  return name.empty() ? "cam" + std::to_string(camera) : name;
}

Figure frameFigure(const StageView& stage) {
  LinePlot plot;
  plot.frame = {"RMSE of every frame", {"time since the first frame [s]"}, {"RMSE [px]"}, 900, 280};
  const std::vector<double> seconds = frameSeconds(stage);
  const auto rmse = frameRmse(stage);
  double largest = 0;
  for (std::size_t camera = 0; camera < rmse.size(); ++camera) {
    Colour colour = seriesColour(camera);
    colour.alpha = 210;
    plot.series.push_back({cameraName(stage, camera), seconds, rmse[camera], colour, 1.1});
    for (const double value : rmse[camera]) {
      if (std::isfinite(value)) largest = std::max(largest, value);
    }
  }
  // From 0, so that a flat series looks flat.
  plot.frame.y.range = Range{0, largest > 0 ? 1.08 * largest : 1};
  return {toSvg(plot, stage.id + "-frames"),
          "Peaks are frames with motion blur, a partly hidden target or false corners; a steady "
          "rise or fall indicates that something moved or warmed up during the recording.",
          true};
}

}  // namespace

Series normalCurve(const std::string& name, double deviation, double range, double area) {
  Series curve{name, {}, {}, {40, 44, 52, 255}, 1.4, true};
  for (int i = 0; i <= 120; ++i) {
    const double x = range * (i / 60.0 - 1);
    curve.x.push_back(x);
    curve.y.push_back(area / (std::sqrt(2 * std::numbers::pi) * deviation) *
                      std::exp(-0.5 * x * x / (deviation * deviation)));
  }
  return curve;
}

std::vector<Block> reprojectionFigures(const StageView& stage) {
  std::vector<Block> blocks = {figureBlock("", {frameFigure(stage)})};
  std::vector<VectorField> fields;
  std::vector<HeatMap> maps;
  double reach = 0;
  for (std::size_t i = 0; i < stage.cameras.size(); ++i) {
    const std::string name = cameraName(stage, i);
    fields.push_back(errorField(stage, static_cast<int>(i), name));
    maps.push_back(errorMap(stage, static_cast<int>(i), name));
    // By the widest cell, as one magnification is that of all cameras.
    reach = std::max(reach,
                     kReach * stage.cameras[i].intrinsics.resolution.width / double{kFieldColumns});
  }
  magnifyAlike(addressesOf(fields), reach);
  scaleAlike(addressesOf(maps));
  for (std::size_t i = 0; i < stage.cameras.size(); ++i) {
    const std::string name = cameraName(stage, i);
    const std::string id = fmt::format("{}-cam{}-", stage.id, i);
    const auto errors = usedErrors(stage, static_cast<int>(i));
    blocks.push_back(figureBlock(
        name, {scatterFigure(errors, name, id + "scatter"),
               histogramFigure(errors, name, id + "histogram"),
               fieldFigure(fields[i], id + "field"), regionFigure(maps[i], id + "region")}));
  }
  return blocks;
}

Section coverageSection(const StageView& stage) {
  std::vector<Figure> figures;
  for (std::size_t i = 0; i < stage.cameras.size(); ++i) {
    const int camera = static_cast<int>(i);
    const ImageGrid grid = binErrors(stage, camera, kMapColumns, Corners::kAll);
    HeatMap map = imageMap(stage, camera, grid, cameraName(stage, i) + ": corners by region");
    map.value_label = "corners";
    for (const std::size_t count : grid.count) {
      // Blank, so that a cell where nothing was seen stands out from one with few corners.
      map.values.push_back(count > 0 ? static_cast<double>(count) : std::nan(""));
    }
    figures.push_back({toSvg(map, fmt::format("coverage-cam{}", i)),
                       "Corners per cell, rejected ones included. Where nothing was seen, "
                       "the distortion is extrapolated."});
  }
  return {
      "coverage",
      "Image coverage",
      "Where in the image the target was seen. Corners near the edges determine the distortion.",
      {figureBlock("", std::move(figures))}};
}

}  // namespace plumbline::html_internal
