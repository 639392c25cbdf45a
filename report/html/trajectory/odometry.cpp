// SPDX-License-Identifier: BSD-3-Clause
// What an odometry says of itself, and what the parameters of its calibration do to its error.
#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "calibrator/base/transform.h"
#include "report/html/trajectory/sections.h"

namespace plumbline::html_internal {
namespace {

/// In another unit; with its deviation, or alone where that is not known.
Cell hinted(double value, const std::optional<double>& deviation, double factor) {
  if (!deviation) return number("{:.3g}", factor * value);
  const double std = factor * *deviation;
  return number("{} \u00b1 {}", withPrecisionOf(factor * value, std), twoDigits(std));
}

/// What the odometry would change of T_SC0, by component.
Table extrinsicsTable(const std::vector<TrajectoryRun>& runs) {
  Table table{{words("Run"), number("tx [mm]"), number("ty [mm]"), number("tz [mm]"),
               number("rx [\u00b0]"), number("ry [\u00b0]"), number("rz [\u00b0]")}};
  for (const TrajectoryRun& run : runs) {
    if (!run.odometry || !run.odometry->T_SC0_hint) continue;
    const OdometryRunRecord& o = *run.odometry;
    std::vector<Cell> row{{runName(run)}};
    for (int i = 0; i < 6; ++i) {
      // A tangent of the pose (dt, da): metres, then radians.
      const double unit = i < 3 ? 1e3 : kDegrees;
      std::optional<double> deviation;
      if (o.T_SC0_hint_std) deviation = (*o.T_SC0_hint_std)[i];
      row.push_back(hinted((*o.T_SC0_hint)[i], deviation, unit));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// The step in the unit in which people read it; a minus where it goes down.
std::string stepText(const ParameterSensitivity& p) {
  const ReadableUnit unit = readable(p.unit);
  // Towards another calibration's value a step has a sign; rounding is no step.
  const double size = std::abs(unit.factor * p.step);
  // A coefficient without a unit may be small itself.
  const bool plain = p.unit == "-";
  const double least = plain ? 1e-12 : 1e-6;
  const std::string step = size < least ? "0" : (p.step < 0 ? "-" : "") + twoDigits(size);
  return plain ? step : step + " " + unit.unit;
}

/// As many digits as chance leaves, to a micrometre.
std::string millimetres(const CalibrationSensitivity& s, double metres) {
  const std::string text =
      withPrecisionOf(1e3 * metres, 1e3 * std::max(s.noise_m.value_or(0), 1e-5));
  return metres > 0 ? "+" + text : text;
}

Cell change(const CalibrationSensitivity& s, const std::optional<double>& metres) {
  return number(metres ? millimetres(s, *metres) : kDash);
}

/// The parameters whose changed runs failed, then the largest of the effects that are told from
/// chance.
std::string effectsOf(const CalibrationSensitivity& s) {
  std::string lost;
  const ParameterSensitivity* largest = nullptr;  // they come largest first
  for (const ParameterSensitivity& p : s.parameters) {
    if (!p.change_m) {
      lost += (lost.empty() ? "" : ", ") + p.name;
    } else if (p.above_chance && !largest) {
      largest = &p;
    }
  }
  std::string text;
  if (!lost.empty()) text = fmt::format("Runs with a change of {} failed. ", lost);
  if (largest) {
    const double change_m = *largest->change_m;
    return text + fmt::format(
                      "{} has the largest effect{}: changed by {}{} it {} the ATE of {:.2f} mm by "
                      "{} mm{}. ",
                      largest->name, lost.empty() ? "" : " of the others", stepText(*largest),
                      largest->minus_m ? " either way" : "", change_m > 0 ? "raises" : "lowers",
                      1e3 * s.ate_m,
                      // Without the sign, which the word has.
                      millimetres(s, std::abs(change_m)).substr(1),
                      largest->minus_m ? " on average" : "");
  }
  return text + fmt::format("No {}parameter changes the ATE of {:.2f} mm by more than chance. ",
                            lost.empty() ? "" : "other ", 1e3 * s.ate_m);
}

/// What the table shows, in words: the largest effect, chance, and how far the single effects add
/// up.
std::string sentenceOf(const CalibrationSensitivity& s) {
  if (s.parameters.empty()) return "The run with the calibration as it is failed.";
  std::string text;
  if (s.noise_m) {
    text = effectsOf(s) + fmt::format(
                              "Chance: {} mm (one standard deviation); dots mark what exceeds it "
                              "twice.",
                              twoDigits(1e3 * *s.noise_m));
  } else {
    text = "Runs with changes by chance failed, so no effect can be told from it.";
  }
  // Of a step to another calibration alone: it is known what all parameters together do.
  if (s.whole_m && s.sum_m && s.interaction_m) {
    text += fmt::format(
        " All changed together: {} mm. The single changes add up to {} mm; interaction: {} mm.",
        millimetres(s, *s.whole_m), millimetres(s, *s.sum_m), millimetres(s, *s.interaction_m));
  }
  return text;
}

Table parametersTable(const CalibrationSensitivity& s) {
  Table table{{words("Parameter"), number("Step"), number("+ step [mm]"),
               number("\u2212 step [mm]"), number("Change of the ATE [mm]")}};
  for (const ParameterSensitivity& p : s.parameters) {
    Cell mean = change(s, p.change_m);
    if (p.above_chance) mean.level = VerdictLevel::kCaution;
    table.rows.push_back({code(p.name), number(stepText(p)), change(s, p.plus_m),
                          change(s, p.minus_m), std::move(mean)});
  }
  return withoutEmptyColumns(std::move(table));
}

}  // namespace

Section selfSection(const std::vector<TrajectoryRun>& runs) {
  Section section{
      "self", "Self-consistency of the odometry",
      "Needs no ground truth. Epipolar: median distance of observations by the other cameras from "
      "the epipolar lines of the first. Innovation: median error of observations at the pose that "
      "the IMU predicts. Closure: the last pose relative to the first; an error only if the rig "
      "ended where it began. The hint of t_d is the time offset under which the IMU predicts the "
      "tracks best, with its standard deviation; estimated alone, it is biased by wrong "
      "extrinsics. For other systems it is the final value of their online calibration, with its "
      "change over the second half. Lower is better between calibrations on one recording, but "
      "none of these is a trajectory error."};
  Table table{{words("Run"), number("Epipolar [px]"), number("Innovation [px]"),
               number("Closure [m]"), number("Closure [\u00b0]"), number("t_d used [ms]"),
               number("t_d, odometry's hint [ms]"), number("Frame, median [ms]"),
               number("95 % [ms]"), number("99 % [ms]"), number("Longest [ms]")}};
  for (const TrajectoryRun& run : runs) {
    if (!run.odometry) continue;
    const OdometryRunRecord& o = *run.odometry;
    table.rows.push_back(
        {words(runName(run)), orDash(o.stereo_px, 1, "{:.3f}"),
         orDash(o.innovation_px, 1, "{:.3f}"), orDash(o.closure_m, 1, "{:.4f}"),
         orDash(o.closure_deg, 1, "{:.3f}"), orDash(o.offset_calibrated_s, 1e3, "{:+.2f}"),
         o.offset_hint_s ? hinted(*o.offset_hint_s, o.offset_hint_std_s, 1e3) : number(kDash),
         orDash(o.frame_p50_ms, 1, "{:.1f}"), orDash(o.frame_p95_ms, 1, "{:.1f}"),
         orDash(o.frame_p99_ms, 1, "{:.1f}"), orDash(o.frame_max_ms, 1, "{:.1f}")});
  }
  section = withTable(std::move(section), withoutEmptyColumns(std::move(table)));
  return withTable(
      std::move(section), extrinsicsTable(runs), "Extrinsics, the odometry's hint",
      "The change of T_SC0 (camera 0 in the IMU) that, with the hint of t_d, lets the IMU predict "
      "the tracks best, with its standard deviations where they are known. No evaluated run uses "
      "it; wrong intrinsics bias it.");
}

Section sensitivitySection(const std::vector<CalibrationSensitivity>& list) {
  Section section{"sensitivity", "Sensitivity",
                  "The built-in odometry, run again with one parameter of the calibration changed "
                  "at a time: by plus and minus its standard deviation (the mean of both is "
                  "shown), or to the value of another calibration."};
  for (const CalibrationSensitivity& s : list) {
    const std::string heading =
        s.towards.empty()
            ? fmt::format("{}, {}: by its standard deviations", s.sequence, s.calibration)
            : fmt::format("{}, {}: to the values of {}", s.sequence, s.calibration, s.towards);
    section.blocks.push_back({heading, sentenceOf(s), parametersTable(s)});
  }
  return section;
}

}  // namespace plumbline::html_internal
