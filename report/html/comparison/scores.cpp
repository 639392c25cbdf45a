// SPDX-License-Identifier: BSD-3-Clause
// What recordings say of the calibrations: scores, predictions, entropies.
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "report/html/comparison/sections.h"
#include "report/plots/svg.h"

namespace plumbline::html_internal {
namespace {

std::string perCamera(const CalibrationScore& s) {
  std::string text;
  for (const auto& [camera, errors] : errorsByCamera(s)) {
    text += fmt::format("{}{} {:.4f}", text.empty() ? "" : ", ", camera, errors.rmse_px);
  }
  return text.empty() ? kDash : text;
}

std::vector<Cell> scoreRow(const CalibrationScore& s) {
  const bool scored = s.reprojection.count > 0;
  std::optional<double> with_imu;
  if (s.camera_imu) with_imu = s.camera_imu->rmse_px;
  return {
      words(s.label),
      words(s.session),
      tight(s.part),
      {!scored      ? kDash
       : s.held_out ? "yes"
                    : "no"},
      orDash(scored ? std::optional(s.reprojection.rmse_px) : std::nullopt, 1, "{:.4f}"),
      words(scored ? perCamera(s) : kDash),
      number(s.views_offered > 0 ? fmt::format("{} of {}", s.views_used, s.views_offered) : kDash),
      orDash(with_imu, 1, "{:.4f}"),
      orDash(s.gyro_rms_rad_s, 1e3, "{:.2f}"),
      orDash(s.accel_rms_m_s2, 1, "{:.4f}"),
      s.problem.empty() ? Cell{} : Cell{s.problem, Cell::Kind::kText, VerdictLevel::kCaution}};
}

Table scoresTable(const std::vector<CalibrationScore>& scores) {
  Table table{{words("Calibration"), words("Recording"), words("Part"),
               words("Known to be held out"), number("RMSE [px]"), words("Per camera [px]"),
               number("Views used"), number("With IMU [px]"), number("Gyro [mrad/s]"),
               number("Accel [m/s\u00b2]"), words("Problem")}};
  for (const CalibrationScore& s : scores) table.rows.push_back(scoreRow(s));
  return table;
}

/// RMSE of a camera over some parts, weighted by corners; NaN where none has it.
double pooledRmse(const std::vector<CalibrationScore>& parts, const std::string& camera) {
  double squares = 0, count = 0;
  for (const CalibrationScore& s : parts) {
    const ErrorStatistics* errors = errorsOf(s, camera);
    if (errors == nullptr) continue;
    const auto n = static_cast<double>(errors->count);
    // The sum of squares that the RMSE is the root of the mean of: so errors pool over corners.
    squares += n * errors->rmse_px * errors->rmse_px;
    count += n;
  }
  return count > 0 ? std::sqrt(squares / count) : std::numeric_limits<double>::quiet_NaN();
}

/// A bar a calibration and camera, pooled over the recordings.
Figure scoreBars(const std::vector<CalibrationScore>& scores) {
  // Never both in one figure: in-sample errors beside held-out ones would look like better ones.
  const bool held_out = std::ranges::any_of(
      scores, [](const CalibrationScore& s) { return s.held_out && s.reprojection.count > 0; });
  BarPlot plot;
  std::string without;
  plot.categories = cameraNames(scores);
  for (const std::string& label :
       distinct(scores, [](const CalibrationScore& s) { return s.label; })) {
    std::vector<CalibrationScore> parts;
    for (const CalibrationScore& s : scores) {
      // Where any calibration has a held-out score, in-sample scores of all are left out.
      const bool counts = s.label == label && s.held_out == held_out && !s.per_camera.empty();
      if (counts) parts.push_back(s);
    }
    if (parts.empty()) {
      without += (without.empty() ? "" : ", ") + label;
      continue;
    }
    std::vector<double> values;
    for (const std::string& camera : plot.categories) values.push_back(pooledRmse(parts, camera));
    plot.names.push_back(label);
    plot.values.push_back(std::move(values));
  }
  if (plot.values.empty()) return {};
  plot.frame = {held_out ? "RMSE per camera, held out" : "RMSE per camera",
                {"camera"},
                {"RMSE [px]"},
                960,
                320};
  std::string caption =
      held_out ? "Corners that none of these calibrations was estimated from; pooled over the "
                 "held-out parts."
               : "None of these scores is known to be held out: an error in sample is optimistic.";
  if (!without.empty()) {
    caption += fmt::format(" Without {} score: {}.", held_out ? "a held-out" : "any", without);
  }
  return {toSvg(plot, "score-bars"), caption, true};
}

/// Calibrations against the first, on the views that both were scored on.
Table pairedTable(const ComparisonRecord& record) {
  Table table{{words("Calibration"), words("Camera"), number("Views"),
               number("Mean difference [px\u00b2]"), number("Std error [px\u00b2]"),
               words("Reading")}};
  const std::string first = record.calibrations.empty() ? "" : record.calibrations[0].label;
  for (const PairedPrediction& p : record.paired) {
    // Negative: the calibration that is compared with the first predicts better.
    const double sigma = p.sigmas();
    const std::string better = sigma < 0 ? p.label : first;
    table.rows.push_back(
        {{p.label + " \u2212 " + first},
         words(p.camera),
         number(p.views),
         number("{:+.4g}", p.difference_px2),
         number(twoDigits(p.std_px2)),
         {!(p.half_px2 > 0) ? "\u2013 (no interval)"
          : p.isClear()
              ? fmt::format("{} has the lower error, by {:.1f} \u03c3", better, std::abs(sigma))
          : p.isSignificant() ? fmt::format("less than {:.0f} % of the RMSE ({:.1f} \u03c3)",
                                            100 * kOfConsequence, std::abs(sigma))
                              : fmt::format("no difference ({:.1f} \u03c3)", std::abs(sigma))}});
  }
  return table;
}

/// One row for each score, where any has such an entropy.
Table entropyTable(const std::vector<CalibrationScore>& scores,
                   std::optional<double> CalibrationScore::*entropy,
                   std::vector<std::string> CalibrationScore::*parameters) {
  Table table{{words("Calibration"), words("Recording"), words("Part"), number("Entropy [nats]"),
               number("Parameters"), words("Of")}};
  bool any = false;
  for (const CalibrationScore& s : scores) {
    const std::optional<double>& value = s.*entropy;
    any = any || value;
    // Parts and recordings without an entropy stay in the table, with the reason.
    const std::string why = s.problem.empty() ? "not computed for this part" : s.problem;
    table.rows.push_back(
        {{s.label},
         words(s.session),
         words(s.part),
         number(value ? fmt::format("{:.2f}", *value) : kDash),
         number(value ? std::to_string((s.*parameters).size()) : kDash),
         {value ? fmt::format("{}", fmt::join(s.*parameters, ", ")) : "\u2013 (" + why + ")"}});
  }
  if (!any) table.rows.clear();
  return table;
}

/// What entropies of the camera-IMU parameters depend on besides the recording.
std::string imuAssumed(const Assumptions& a) {
  std::string text =
      "Poses, velocities, biases and gravity's direction are marginalised; the cameras and the "
      "differences between their time offsets are fixed. Under the recording's noise densities";
  if (a.imu_noise) {
    text += fmt::format(
        ": gyroscope {:.5g} rad/s/\u221aHz (walk {:.5g}), accelerometer {:.5g} m/s\u00b2/\u221aHz "
        "(walk {:.5g})",
        a.imu_noise->gyro_density, a.imu_noise->gyro_random_walk, a.imu_noise->accel_density,
        a.imu_noise->accel_random_walk);
  }
  return text + ".";
}

}  // namespace

Section scoresSection(const ComparisonRecord& record) {
  Section section{"scores", "Scores on recordings",
                  "Every calibration is fixed; only the target's poses (and with an IMU the states "
                  "and gravity) are estimated. Corners and rule are the same for all, unlike the "
                  "in-sample errors that the tools report."};
  if (record.scores.empty()) return section;
  section = withTable(std::move(section), scoresTable(record.scores));
  section = withFigures(std::move(section), {scoreBars(record.scores)});
  return withTable(
      std::move(section), pairedTable(record), "Which predicts better, view by view",
      "Mean over views of the difference in mean squared error; negative means that the first one "
      "is better. The standard error is computed from blocks of consecutive views.");
}

Section entropySection(const ComparisonRecord& record) {
  Section section{
      "entropy", "Entropy",
      fmt::format("0.5 log((2\u03c0e)\u207f |\u03a3|) of the parameters on that recording, in "
                  "nats, for a corner noise of {:g} px; lower is better determined. Compare it "
                  "only under the same parameters, units and noise.",
                  record.assumptions.pixel_sigma_px)};
  section = withTable(std::move(section),
                      entropyTable(record.scores, &CalibrationScore::entropy_nats,
                                   &CalibrationScore::entropy_parameters),
                      "Cameras", "All corners have the same weight; poses are marginalised.");
  return withTable(std::move(section),
                   entropyTable(record.scores, &CalibrationScore::camera_imu_entropy_nats,
                                &CalibrationScore::camera_imu_entropy_parameters),
                   "Camera-IMU", imuAssumed(record.assumptions));
}

}  // namespace plumbline::html_internal
