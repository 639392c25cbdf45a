// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "report/html/trajectory/sections.h"
#include "report/plots/characters.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

constexpr std::size_t kLeastRepeats = 3;  // runs that make a box; the caption says so

/// How the values of a group become a box; fewer than `fewest` are points in its place.
struct BoxRule {
  double least = 0, most = 1;  ///< quantiles of the whiskers
  std::size_t fewest = 1;
};

/// Boxes of few values would pretend to a spread.
void addGroup(BoxPlot& plot, const BoxRule& rule, const std::string& name, std::size_t series,
              const std::vector<double>& values) {
  BoxSummary box{name, {}, series};
  if (values.size() >= rule.fewest) {
    box.quantiles = {quantile(values, rule.least), quantile(values, 0.25), quantile(values, 0.5),
                     quantile(values, 0.75), quantile(values, rule.most)};
  } else {
    box.quantiles.fill(std::nan(""));
    const auto x = static_cast<double>(plot.boxes.size());
    for (const double value : values) {
      plot.points.push_back(
          {x, value, fmt::format("{}: {:.4g} m", name, value), "", seriesColour(series)});
    }
  }
  plot.boxes.push_back(std::move(box));
}

/// Values of each (sequence, calibration) in the order of appearance.
BoxPlot boxesBySequence(const std::vector<TrajectoryRun>& runs, const BoxRule& rule,
                        const auto& collect) {
  BoxPlot plot;
  plot.series = calibrationsOf(runs);
  for (const std::string& sequence : sequencesOf(runs)) {
    for (std::size_t k = 0; k < plot.series.size(); ++k) {
      std::vector<double> values;
      for (const TrajectoryRun& run : runs) {
        if (run.sequence == sequence && run.calibration == plot.series[k]) collect(run, values);
      }
      // quantile() sorts, and NaN has no place in an order.
      std::erase_if(values, [](double v) { return !std::isfinite(v); });
      if (!values.empty()) addGroup(plot, rule, sequence, k, values);
    }
  }
  return plot;
}

/// Over all poses of the runs of a sequence; failedRun() has left none to those that failed.
Figure alongFigure(const std::vector<TrajectoryRun>& runs) {
  BoxPlot plot = boxesBySequence(
      runs, {0.05, 0.95}, [](const TrajectoryRun& run, std::vector<double>& values) {
        values.insert(values.end(), run.error_m.begin(), run.error_m.end());
      });
  if (plot.boxes.empty()) return {};
  frameBoxes(plot, "Position error along the trajectories", "position error [m]");
  return {toSvg(plot, "ate-along"),
          "All paired poses of a sequence's runs under one calibration: whiskers at 5 and 95 %, "
          "box from 25 to 75 %, line at the median." +
              std::string(runs.size() > 1 ? " Failed runs have no poses to show; see the "
                                            "completion above."
                                          : ""),
          true};
}

/// One value a run: how far repeating a run changes its error. Of a partial one it would be that of
/// the part that it covers.
Figure repeatsFigure(const std::vector<TrajectoryRun>& runs) {
  const auto collect = [](const TrajectoryRun& run, std::vector<double>& values) {
    if (run.status == RunStatus::kComplete && run.ate_translation_m.n > 0) {
      values.push_back(run.ate_translation_m.rmse);
    }
  };
  BoxPlot plot = boxesBySequence(runs, {0, 1, kLeastRepeats}, collect);
  const bool any_box = std::ranges::any_of(
      plot.boxes, [](const BoxSummary& box) { return std::isfinite(box.quantiles[2]); });
  if (!any_box) return {};
  frameBoxes(plot, "RMSE of complete runs", "ATE RMSE [m]");
  const std::string few = plot.points.empty() ? "" : " Fewer than three runs are shown as points.";
  return {toSvg(plot, "ate-runs"),
          "One value a run: whiskers at the best and the worst, box from 25 to 75 %, line at the "
          "median. Partial and failed runs are not in it." +
              few,
          true};
}

}  // namespace

void frameBoxes(BoxPlot& plot, const std::string& title, const std::string& label) {
  plot.frame.title = title;
  plot.frame.width = 960;
  double top = 0;
  std::size_t longest = 0;
  for (const BoxSummary& box : plot.boxes) {
    top = std::max(top, box.quantiles[4]);
    longest = std::max(longest, internal::characterCount(box.name));
  }
  for (const NamedPoint& point : plot.points) top = std::max(top, point.y);
  // About as many letters fit side by side below 960 px.
  plot.frame.x.upright_labels = longest * plot.boxes.size() > 110;
  plot.frame.height = plot.frame.x.upright_labels ? 400 : 340;
  plot.frame.y.label = label;
  plot.frame.y.range = Range{0, top > 0 ? 1.06 * top : 1};
}

Section errorSection(const std::vector<TrajectoryRun>& runs) {
  Section section{"ate", "Absolute errors",
                  "Distance between the aligned estimate and the truth, per sequence and "
                  "calibration."};
  return withFigures(std::move(section), {repeatsFigure(runs), alongFigure(runs)});
}

}  // namespace plumbline::html_internal
