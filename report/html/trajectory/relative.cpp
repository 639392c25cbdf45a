// SPDX-License-Identifier: BSD-3-Clause
// Errors of relative motion by distance.
#include <array>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "report/html/trajectory/sections.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

/// p5, quartiles and p95 of what a relative error's statistics keep.
std::array<double, 5> fiveOf(const SampleStatistics& s) {
  // Of kPercents: 5, 25, 75 and 95 stand at 1 to 4.
  return {s.percentiles[1], s.percentiles[2], s.median, s.percentiles[3], s.percentiles[4]};
}

/// The median over runs of each of the five numbers, which need not be those of any one run.
std::array<double, 5> medianOf(const std::vector<std::array<double, 5>>& all) {
  std::array<double, 5> result{};
  for (std::size_t i = 0; i < result.size(); ++i) {
    std::vector<double> column;
    for (const auto& five : all) column.push_back(five[i]);
    result[i] = quantile(column, 0.5);
  }
  return result;
}

using Distance = std::pair<std::string, double>;  // unit, delta

std::string lengthText(const Distance& distance) {
  return fmt::format("{:g} {}", distance.second, distance.first);
}

/// Those that any run was evaluated over, by unit, then by length. Lengths are those that were
/// asked for, so that equal ones are equal to the last bit.
std::set<Distance> distancesOf(const std::vector<TrajectoryRun>& runs) {
  std::set<Distance> all;
  for (const TrajectoryRun& run : runs) {
    for (const RelativeErrorRecord& r : run.rpe) all.emplace(r.unit, r.delta);
  }
  return all;
}

/// Of the runs under a calibration, those over a distance.
std::vector<const RelativeErrorRecord*> errorsOver(const std::vector<TrajectoryRun>& runs,
                                                   const std::string& calibration,
                                                   const Distance& distance) {
  std::vector<const RelativeErrorRecord*> found;
  for (const TrajectoryRun& run : runs) {
    if (run.calibration != calibration) continue;
    for (const RelativeErrorRecord& r : run.rpe) {
      if (Distance(r.unit, r.delta) == distance) found.push_back(&r);
    }
  }
  return found;
}

/// Boxes of every length and calibration; `what`: the translation [m] or the rotation [degree].
BoxPlot relativeBoxes(const std::vector<TrajectoryRun>& runs,
                      SampleStatistics RelativeErrorRecord::*what) {
  BoxPlot plot;
  plot.series = calibrationsOf(runs);
  for (const Distance& distance : distancesOf(runs)) {
    for (std::size_t k = 0; k < plot.series.size(); ++k) {
      std::vector<std::array<double, 5>> all;
      for (const RelativeErrorRecord* r : errorsOver(runs, plot.series[k], distance)) {
        if ((r->*what).n > 0) all.push_back(fiveOf(r->*what));
      }
      if (!all.empty()) plot.boxes.push_back({lengthText(distance), medianOf(all), k});
    }
  }
  return plot;
}

/// Of one distance under one calibration: the median over runs, and what it stands on.
std::vector<Cell> relativeRow(const std::vector<TrajectoryRun>& runs, const std::string& name,
                              const Distance& distance) {
  std::vector<double> metres, degrees;
  std::string pairs;
  std::size_t pieces = 0;
  for (const RelativeErrorRecord* r : errorsOver(runs, name, distance)) {
    if (r->translation_m.n == 0) continue;
    // A run counts as one, however many pairs it has.
    metres.push_back(r->translation_m.rmse);
    degrees.push_back(r->rotation_deg.rmse);
    pieces += r->translation_m.n;
    pairs = r->pairs;
  }
  if (metres.empty()) return {};
  return {words(name.empty() ? kDash : name),
          tight(lengthText(distance)),
          tight(pairs),
          number(metres.size()),
          number(grouped(pieces)),
          number("{:.4f}", quantile(metres, 0.5)),
          number("{:.4f}", quantile(degrees, 0.5))};
}

Table relativeTable(const std::vector<TrajectoryRun>& runs) {
  Table table{{words("Calibration"), words("Length"), words("Pair selection"), number("Runs"),
               number("Pairs"), number("Translation RMSE [m]"), number("Rotation RMSE [\u00b0]")}};
  for (const Distance& distance : distancesOf(runs)) {
    for (const std::string& name : calibrationsOf(runs)) {
      auto row = relativeRow(runs, name, distance);
      if (!row.empty()) table.rows.push_back(std::move(row));
    }
  }
  return withoutEmptyColumns(std::move(table));
}

}  // namespace

Section relativeSection(const std::vector<TrajectoryRun>& runs) {
  Section section{
      "rpe", "Relative errors by distance",
      "Error of the motion over segments of each length: whiskers at 5 and 95 %, box from 25 to 75 "
      "%, line at the median over the segments; for several runs the median of each of these."};
  section = withTable(std::move(section), relativeTable(runs));
  std::vector<Figure> figures;
  const auto add = [&](SampleStatistics RelativeErrorRecord::*what, const char* title,
                       const char* label, const char* id) {
    BoxPlot plot = relativeBoxes(runs, what);
    if (plot.boxes.empty()) return;
    frameBoxes(plot, title, label);
    figures.push_back({toSvg(plot, id), "", true});
  };
  add(&RelativeErrorRecord::translation_m, "Translation", "translation error [m]",
      "rpe-translation");
  add(&RelativeErrorRecord::rotation_deg, "Rotation", "rotation error [\u00b0]", "rpe-rotation");
  return withFigures(std::move(section), std::move(figures));
}

}  // namespace plumbline::html_internal
