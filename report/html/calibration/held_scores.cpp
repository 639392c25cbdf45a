// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "report/html/calibration/sections.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

using Scores = std::vector<CalibrationScore>;

/// Of the words of CalibrationScore::part.
bool isWhole(const CalibrationScore& s) { return s.part == "all"; }

/// "all 5 folds" stands for every fold in the plot.
bool isPooled(const CalibrationScore& s) { return s.part.rfind("all ", 0) == 0; }

std::string rmseText(const ErrorStatistics* s) {
  return s != nullptr && s->count > 0 ? fmt::format("{:.4f}", s->rmse_px) : kDash;
}

std::vector<Cell> rowOf(const CalibrationScore& s, const std::vector<std::string>& cameras) {
  const bool scored = s.reprojection.count > 0;
  // The other part of a fold is what its own calibration was estimated from.
  std::vector<Cell> row = {tight(s.session), tight(isWhole(s) ? "whole" : s.part),
                           tight(s.held_out   ? "held out"
                                 : isWhole(s) ? "scored"
                                              : "calibrated on"),
                           number(rmseText(&s.reprojection))};
  for (const std::string& camera : cameras) row.push_back(number(rmseText(errorsOf(s, camera))));
  row.insert(
      row.end(),
      {number(scored ? fmt::format("{:.4f}", s.reprojection.median_px) : kDash),
       number(scored ? grouped(s.reprojection.count) : kDash),
       number(s.views_offered > 0 ? fmt::format("{} of {}", s.views_used, s.views_offered) : kDash),
       number(rmseText(s.camera_imu ? &*s.camera_imu : nullptr)),
       orDash(s.gyro_rms_rad_s, 1e3, "{:.2f}"), orDash(s.accel_rms_m_s2, 1, "{:.4f}")});
  return row;
}

Table scoresTable(const Scores& scores) {
  const std::vector<std::string> cameras = cameraNames(scores);
  Table table{{words("Recording"), words("Part"), words("Corners are"), number("RMSE [px]")}};
  for (const std::string& camera : cameras) table.columns.push_back(number(camera + " [px]"));
  table.columns.insert(table.columns.end(), {number("Median [px]"), number("Corners"),
                                             number("Views used"), number("With IMU [px]"),
                                             number("Gyro [mrad/s]"), number("Accel [m/s\u00b2]")});
  for (const CalibrationScore& s : scores) table.rows.push_back(rowOf(s, cameras));
  const bool with_imu = std::ranges::any_of(
      scores, [](const CalibrationScore& s) { return s.camera_imu.has_value(); });
  if (!with_imu) eraseColumns(table, std::ssize(table.columns) - 3, 3);
  return table;
}

/// RMSE per camera of whole recordings and of all folds together.
Figure barsOf(const Scores& scores) {
  BarPlot plot;
  plot.categories = cameraNames(scores);
  for (const CalibrationScore& s : scores) {
    // Single folds are in the table; in the plot they would hide what they add up to.
    if (s.reprojection.count == 0 || !(isPooled(s) || isWhole(s))) continue;
    std::vector<double> values;
    for (const std::string& camera : plot.categories) {
      const ErrorStatistics* errors = errorsOf(s, camera);
      const bool known = errors != nullptr && errors->count > 0;
      values.push_back(known ? errors->rmse_px : std::numeric_limits<double>::quiet_NaN());
    }
    plot.names.push_back((isWhole(s) ? s.session : s.part) + (s.held_out ? ", held out" : ""));
    plot.values.push_back(std::move(values));
  }
  // One group of bars compares nothing.
  if (plot.values.size() < 2) return {};
  plot.frame = {"RMSE per camera", {"camera"}, {"RMSE [px]"}, 960, 320};
  return {toSvg(plot, "held-scores"),
          "A clearly larger error on held-out corners than on the corners of the calibration "
          "indicates an overfitted model, or different conditions.",
          true};
}

enum class ScoredPart { kOwn, kOthers, kFolds };

/// The first recording, those after it, or all parts of the first, which stand together so that
/// each fold's two errors can be compared.
Scores chosen(const Scores& scores, ScoredPart part) {
  Scores out;
  for (const CalibrationScore& s : scores) {
    const ScoredPart of = !isWhole(s)             ? ScoredPart::kFolds
                          : &s == &scores.front() ? ScoredPart::kOwn
                                                  : ScoredPart::kOthers;
    if (of == part) out.push_back(s);
  }
  return out;
}

}  // namespace

Section heldScoresSection(const HeldCalibration& held) {
  Section section{"scores", "Scores",
                  fmt::format("{} is fixed; only the target's poses, and with an IMU the states "
                              "and gravity's direction, are estimated.",
                              held.file)};
  for (const CalibrationScore& s : held.scores) {
    if (!s.problem.empty()) {
      section.remarks.push_back(
          fmt::format("{}, {}: {}", s.session, isWhole(s) ? "whole" : s.part, s.problem));
    }
  }
  const auto tableOf = [&](ScoredPart part) { return scoresTable(chosen(held.scores, part)); };
  section = withTable(std::move(section), tableOf(ScoredPart::kOwn), "This recording");
  section = withTable(std::move(section), tableOf(ScoredPart::kOthers), "Other recordings");
  section = withTable(std::move(section), tableOf(ScoredPart::kFolds), "K-fold validation",
                      "This recording recalibrated without one part at a time, with the same "
                      "camera models; each part is scored with the calibration that did not use "
                      "it.");
  return withFigures(std::move(section), {barsOf(held.scores)});
}

}  // namespace plumbline::html_internal
