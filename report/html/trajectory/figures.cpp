// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/time.h"
#include "report/html/figure.h"
#include "report/html/trajectory/sections.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

constexpr std::size_t kOverlays = 12;  // runs that are drawn
constexpr Colour kTruth{150, 156, 166, 255};

/// A run without a truth has no pairs, nor has one that failed before they were made.
bool drawable(const TrajectoryRun& run) {
  return run.t.size() > 1 && run.truth_m.size() == run.t.size() &&
         run.estimate_m.size() == run.t.size() && run.error_m.size() == run.t.size();
}

/// Axes of one view of a path.
struct View {
  int x = 0, y = 1;
  const char* name = "";
  const char* id = "";
};
constexpr View kViews[] = {{0, 1, "top view", "top"}, {0, 2, "side view", "side"}};
constexpr const char* kAxes[] = {"x [m]", "y [m]", "z [m]"};

std::vector<double> component(const std::vector<Eigen::Vector3d>& points, int axis) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const auto& p : points) values.push_back(p[axis]);
  return values;
}

/// The range about its middle, at least as wide as `span`.
Range wider(const Range& range, double span) {
  const double more = std::max(0.0, (span - (range.max - range.min)) / 2);
  return {range.min - more, range.max + more};
}

/// Truth in grey and estimate in the colours of its errors, projected along an axis of the world.
Figure viewFigure(const TrajectoryRun& run, const View& view, const Range& errors,
                  const std::string& id) {
  LinePlot plot;
  const auto tx = component(run.truth_m, view.x), ty = component(run.truth_m, view.y);
  const auto ex = component(run.estimate_m, view.x), ey = component(run.estimate_m, view.y);
  Range x = rangeOf({&tx, &ex}, 0.04), y = rangeOf({&ty, &ey}, 0.04);
  const double least = 0.35 * std::max(x.max - x.min, y.max - y.min);  // no slits
  x = wider(x, least);
  y = wider(y, least);
  plot.frame = {view.name, {kAxes[view.x], x}, {kAxes[view.y], y}, 480, 420, true};
  plot.series = {{"truth", tx, ty, kTruth, 1}};
  plot.coloured = {{ex, ey, run.error_m, 2}};
  plot.value_label = "position error [m]";
  plot.value_range = errors;
  return {toSvg(plot, id + "-" + view.id), ""};
}

/// Colours up to the 99th percentile, so that one stray pose does not pale the rest; runs of one
/// sequence have one scale, the largest of them. Failed ones have no errors.
Range colourRange(const std::vector<TrajectoryRun>& runs, const TrajectoryRun& run) {
  Range range{0, 0};
  for (const TrajectoryRun& other : runs) {
    if (other.sequence != run.sequence) continue;
    std::vector<double> known;
    addFinite(other.error_m, known);
    if (!known.empty()) range.max = std::max({range.max, 1e-9, quantile(known, 0.99)});
  }
  if (range.max == 0) range.max = 1;
  return range;
}

/// An error of every pair: which, and how it is named.
struct PairError {
  std::vector<double> TrajectoryRun::*values;
  const char* title;
  const char* label;
  const char* id;
};

constexpr PairError kPairErrors[] = {
    {&TrajectoryRun::error_m, "Position error over time", "position error [m]", "error-time"},
    {&TrajectoryRun::error_deg, "Rotation error over time", "rotation error [\u00b0]",
     "rotation-time"}};

Series timeSeries(const TrajectoryRun& run, const std::vector<double>& values, Colour colour,
                  TimeNs start) {
  Series series{"", {}, {}, colour, 1.2};
  for (std::size_t i = 0; i < run.t.size(); ++i) {
    series.x.push_back(secondsBetween(start, run.t[i]));
    series.y.push_back(values[i]);
  }
  return series;
}

/// One line a run, in the colour of its calibration.
Figure timeFigure(const std::vector<TrajectoryRun>& runs, const std::string& sequence,
                  const PairError& error, const std::string& id) {
  const std::vector<std::string> names = calibrationsOf(runs);
  LinePlot plot;
  TimeNs start = std::numeric_limits<TimeNs>::max();
  for (const TrajectoryRun& run : runs) {
    // One axis of time for all runs of a sequence.
    if (run.sequence == sequence && drawable(run)) start = std::min(start, run.t.front());
  }
  std::vector<bool> named(names.size(), false);
  double top = 0;
  for (const TrajectoryRun& run : runs) {
    const std::vector<double>& values = run.*error.values;
    if (run.sequence != sequence || !drawable(run) || values.size() != run.t.size()) continue;
    const std::size_t k = placeOf(names, run.calibration);
    plot.series.push_back(timeSeries(run, values, seriesColour(k), start));
    // One entry of the legend for all runs of a calibration.
    if (!named[k]) plot.series.back().name = names[k];
    named[k] = true;
    for (const double e : values) top = std::isfinite(e) ? std::max(top, e) : top;
  }
  if (plot.series.empty()) return {};
  plot.frame = {sequence.empty() ? error.title : fmt::format("{}: {}", sequence, error.title),
                {"time since the first pair [s]"},
                {error.label, Range{0, top > 0 ? 1.06 * top : 1}},
                960,
                260};
  return {toSvg(plot, id), "", true};
}

/// Three components of the pose over time: the truth's and the aligned estimate's.
struct PoseComponents {
  std::vector<Eigen::Vector3d> TrajectoryRun::*truth;
  std::vector<Eigen::Vector3d> TrajectoryRun::*estimate;
  std::array<const char*, 3> names;
  const char* title;
  const char* label;
  const char* id;
};

constexpr PoseComponents kPositions{&TrajectoryRun::truth_m, &TrajectoryRun::estimate_m,
                                    {"x", "y", "z"},         "position over time",
                                    "position [m]",          "time"};
constexpr PoseComponents kOrientations{&TrajectoryRun::truth_rpy_deg,
                                       &TrajectoryRun::estimate_rpy_deg,
                                       {"roll", "pitch", "yaw"},
                                       "orientation over time",
                                       "angle [\u00b0]",
                                       "angles"};

/// Each of the three over time, the truth's wide and grey beneath.
Figure componentsFigure(const TrajectoryRun& run, const PoseComponents& of, const std::string& id) {
  LinePlot plot;
  for (int i = 0; i < 3; ++i) {
    plot.series.push_back(timeSeries(run, component(run.*of.truth, i), kTruth, run.t.front()));
    // Wide, so that it is seen on both sides of an estimate that follows it.
    plot.series.back().width = 2.4;
    if (i == 0) plot.series.back().name = "truth";
  }
  for (std::size_t i = 0; i < 3; ++i) {
    plot.series.push_back(timeSeries(run, component(run.*of.estimate, static_cast<int>(i)),
                                     seriesColour(i), run.t.front()));
    plot.series.back().name = of.names[i];
  }
  plot.frame = {of.title, {"time since the first pair [s]"}, {of.label}, 960, 260};
  return {toSvg(plot, id + "-" + of.id), "", true};
}

Block overlayBlock(const TrajectoryRun& run, const Range& colours, std::size_t index) {
  Block block;
  block.heading = runName(run);
  block.text = fmt::format("ATE RMSE {:.4f} m over {} pairs{}.", run.ate_translation_m.rmse,
                           run.association.matches, run.problem.empty() ? "" : "; " + run.problem);
  const std::string id = fmt::format("overlay-{}", index);
  for (const View& view : kViews) block.figures.push_back(viewFigure(run, view, colours, id));
  block.figures.push_back(componentsFigure(run, kPositions, id));
  const bool turned = run.truth_rpy_deg.size() == run.t.size();
  if (turned && run.estimate_rpy_deg.size() == run.t.size()) {
    block.figures.push_back(componentsFigure(run, kOrientations, id));
  }
  return block;
}

}  // namespace

std::vector<std::string> sequencesOf(const std::vector<TrajectoryRun>& runs) {
  return distinct(runs, [](const TrajectoryRun& run) { return run.sequence; });
}

Section overlaySection(const std::vector<TrajectoryRun>& runs) {
  Section section{"overlays", "Overlays",
                  "The aligned estimate in the colour of its position error (one scale for the "
                  "runs of a sequence, which ends at their largest 99th percentile), the truth in "
                  "thin grey. Both axes of a view have the same scale; z points up where the "
                  "truth's frame does. Roll, pitch and yaw are those of "
                  "R = Rz(yaw) Ry(pitch) Rx(roll), body to the truth's world."};
  // Up to four figures a run; tables and boxes have all runs, drawn here or not.
  std::size_t drawn = 0, more = 0;
  for (const TrajectoryRun& run : runs) {
    if (!drawable(run)) continue;
    if (drawn < kOverlays) {
      section.blocks.push_back(overlayBlock(run, colourRange(runs, run), drawn++));
    } else {
      ++more;
    }
  }
  if (more > 0) {
    section.remarks.push_back(
        fmt::format("{} further runs are in the tables and boxes, but not drawn here.", more));
  }
  return section;
}

Section timeSection(const std::vector<TrajectoryRun>& runs) {
  Section section{"error-time", "Errors over time",
                  "A sudden step is a relocalisation or a lost track; a slow rise is drift."};
  std::vector<Figure> figures;
  std::size_t index = 0;
  for (const std::string& sequence : sequencesOf(runs)) {
    for (const PairError& error : kPairErrors) {
      figures.push_back(timeFigure(runs, sequence, error, fmt::format("{}-{}", error.id, index)));
    }
    ++index;
  }
  return withFigures(std::move(section), std::move(figures));
}

}  // namespace plumbline::html_internal
