// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "calibrator/batch/camera_imu/stage.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
namespace {

/// Errors of cameras look like noise of the IMU: what is said of those that were given.
std::string adviceOnDensity(const CalibrationRecord& record) {
  const auto& faults = record.camera_imu->faults;
  const bool is_open = faults && faults->alternative &&
                       (faults->alternative->fault == UnmodelledFault::kGivenCameras ||
                        faults->causes.front().fault == UnmodelledFault::kGivenCameras);
  if (is_open) {
    return "Find out first whether it is the given cameras that do not suit this recording (see "
           "the unmodelled fault): such errors can look like noise of the IMU.";
  }
  if (faults && findBy(faults->causes, &FaultTest::fault, UnmodelledFault::kGivenCameras)) {
    return "Mend the given cameras first: they do not suit this recording, and such errors can "
           "look like noise of the IMU.";
  }
  // Cameras that were calibrated with this recording suit it. Given ones are tested with the
  // faults, which takes a recording that is long enough.
  const bool untested = !record.camera && !faults;
  return fmt::format(
      "The density in imu.yaml is too small for this recording: raise it by that factor, or "
      "look for vibration, saturation, blur{} or a wrong IMU scale. Standard deviations are too "
      "small until then.",
      untested ? ", given cameras that do not suit the recording (not tested)" : "");
}

// "; the longest, 0.20 s, after imu0/data.csv:2401".
std::string pausesIn(const Screening& screening) {
  const auto longest = std::max_element(
      screening.pauses.begin(), screening.pauses.end(),
      [](const ImuPause& a, const ImuPause& b) { return a.duration_s < b.duration_s; });
  if (longest == screening.pauses.end()) return "";
  return fmt::format("; the longest, {:.3g} s, after {}", longest->duration_s,
                     sampleName(longest->t, longest->line));
}

// The cameras' own time offsets, where they were found not to be synchronised.
std::optional<Finding> judgeSynchrony(const CameraImuStageResult& stage,
                                      const VerdictThresholds& t) {
  const ImuCalibration& imu = stage.imu;
  if (!haveOwnOffsets(imu.time_offsets)) return std::nullopt;
  // Of any two cameras: neither need be the first.
  double earliest_ms = 1e3 * imu.timeOffset(), latest_ms = earliest_ms;
  std::vector<std::string> list;
  for (std::size_t i = 0; i < imu.time_offsets.size(); ++i) {
    const double offset_ms = 1e3 * imu.timeOffset(i);
    earliest_ms = std::min(earliest_ms, offset_ms);
    latest_ms = std::max(latest_ms, offset_ms);
    list.push_back(fmt::format("{} {:+.4f}", stage.cameras[i].name, offset_ms));
  }
  return above(
      {"Cameras exposed together", "ms", t.camera_shift_ms,
       "Trigger the cameras together: the camera stage treats paired views as simultaneous, and a "
       "filter with one offset for all cameras cannot use these offsets."},
      latest_ms - earliest_ms, "time offsets [ms]: " + joined(list));
}

// One figure of the linear fit ahead of the batch. It names no cause and is never bad: noise of the
// poses' attitudes, times gravity, stands among its regressors and makes targets seem larger where
// the rig moves gently (by 3 to 4 % in recordings by hand that are in order).
Finding untested(Rule rule, double value, std::string evidence) {
  rule.advice =
      "Faults were not tested: record 10 s or more in which the target is seen, with brisk motion. "
      "Without, a wrong target size, a wrong focal length, IMU faults and gentle motion cannot be "
      "distinguished.";
  const VerdictLevel level = std::min(VerdictLevel::kCaution, levelAbove(value, rule.bound));
  return finding(rule, level, value, std::move(evidence));
}

// Scale and gravity by the linear fit. Where the score tests at the batch's optimum were made, they
// alone say whether target or accelerometer are off: they weigh noise and hold every alternative.
Findings judgeLinearFit(const CameraImuStageResult& stage, double assumed_m_s2,
                        const VerdictThresholds& t) {
  Findings findings;
  const InertialCheck& check = stage.inertial_check;
  if (stage.faults || check.gravity_m_s2 <= 0) return findings;
  findings.push_back(
      untested({"Gravity by the linear fit", "share", t.gravity, ""},
               std::abs(check.gravity_m_s2 / assumed_m_s2 - 1),
               fmt::format("measured {:.3f} m/s^2, assumed {:.3f}; the cause was not tested",
                           check.gravity_m_s2, assumed_m_s2)));
  // Where the fit leaves more than noise, its scale says nothing of the target.
  if (check.residual_ratio > t.inertial_fit.caution) return findings;
  const Rule rule{"Scale by the linear fit", "share", t.target_scale, ""};
  Finding scale = untested(
      rule,
      // What two deviations do not explain of the difference; NaN stays NaN.
      std::max(std::abs(check.target_scale - 1) - 2 * check.target_scale_std, 0.0),
      fmt::format(
          "{:.4f} (+- {:.4f}) metres per stated metre of the target; the cause was not tested",
          check.target_scale, check.target_scale_std));
  // A size that would be bad stays unseen here.
  if (scale.level == VerdictLevel::kGood && !(2 * check.target_scale_std <= t.target_scale.bad)) {
    scale = notJudged(rule, fmt::format("{:.4f} (+- {:.4f}) metres per stated metre of the target; "
                                        "scale rests on the stated size",
                                        check.target_scale, check.target_scale_std));
  }
  findings.push_back(std::move(scale));
  return findings;
}

// What the fault in the model would move, the largest component of T_SC0 and the time offset, in
// the larger of formal and robust standard deviation, which the verdict judges.
double movedInDeviations(const FaultTest& test, const FaultDiagnosis& diagnosis) {
  double most = 0;
  for (Eigen::Index k = 0; k < test.shift.size(); ++k) {
    const double std = std::max(diagnosis.formal_std(k), diagnosis.robust_std(k));
    const double moved = std::abs(test.shift(k)) / std;
    if (isLarger(moved, most)) most = moved;
  }
  return most;
}

constexpr double kSizeSigmas = 3;

// Deviations within which a size by its score test is known. More where few blocks estimate them,
// as of a cause: of 1500 simulated clean recordings of eight seconds nine exceeded a significance
// of three, and two should.
double sureSigmas(const CameraImuStageResult& stage) {
  return significanceBound(kSizeSigmas, 1, diagnosedBlocks(stage.frames));
}

// The size by its score test, where no cause is named. Only the size is asked for here, which takes
// less evidence than the largest of all tests does: where a rig moves gently, a size that is off by
// 2 or 3 % stays below the bound of a cause, and moves T_SC0 by several deviations. Caution is a
// size that is surely off by more than the bound, or that moves the calibration so far.
std::optional<Finding> judgeTargetSize(const CameraImuStageResult& stage,
                                       const VerdictThresholds& t) {
  if (!stage.faults || !stage.faults->causes.empty()) return std::nullopt;
  const std::vector<FaultTest>& tests = stage.faults->tests;
  const FaultTest* size = findBy(tests, &FaultTest::fault, UnmodelledFault::kTargetSize);
  if (!size) return std::nullopt;
  const double off = size->estimate(0);
  const double std = size->std(0);
  const double sure = sureSigmas(stage);
  Rule rule{"Size of the target by the batch", "share", t.target_scale,
            "Measure a tag's black square against tagSize in target.yaml. If it agrees, record "
            "again with brisker motion: this recording is not conclusive."};
  if (std::abs(off) > kLinearShare) {
    return notJudged(rule,
                     "the motion does not tell the target's size; scale rests on the stated "
                     "one");
  }
  // What these deviations leave of the estimate at least, so that an uncertain one is good; NaN
  // stays NaN.
  const bool differs = !(size->significance <= sure);
  const double least = differs ? std::max(std::abs(off) - sure * std, 0.0) : 0;
  const double moved = movedInDeviations(*size, *stage.faults);
  VerdictLevel level = std::min(VerdictLevel::kCaution, levelAbove(least, rule.bound));
  double value = least;
  if (level == VerdictLevel::kGood && differs && !(moved <= kSizeSigmas)) {
    rule.unit = "sigma";
    rule.bound.caution = kSizeSigmas;
    level = VerdictLevel::kCaution;
    value = moved;
  }
  // A size that would be bad stays unseen here.
  if (level == VerdictLevel::kGood && !(sure * std <= t.target_scale.bad)) {
    return notJudged(rule, fmt::format("the motion tells the target's size to +- {:.1f} % only (1 "
                                       "sigma); scale rests on the stated one",
                                       100 * std));
  }
  return finding(
      rule, level, value,
      fmt::format("the residuals suggest {:+.2f} % (+- {:.2f}) of the stated size ({:.1f} standard "
                  "deviations), which would move the calibration by {:.1f} of its own",
                  100 * off, 100 * std, std::max(size->significance, 0.0), moved));
}

}  // namespace

bool testsTargetSize(const CalibrationRecord& record, const VerdictThresholds& t) {
  if (!record.camera_imu) return false;
  const CameraImuStageResult& stage = *record.camera_imu;
  if (!stage.faults) {
    const InertialCheck& check = stage.inertial_check;
    return check.gravity_m_s2 > 0 && check.residual_ratio <= t.inertial_fit.caution &&
           2 * check.target_scale_std <= t.target_scale.bad;
  }
  const FaultTest* size =
      findBy(stage.faults->tests, &FaultTest::fault, UnmodelledFault::kTargetSize);
  return size && std::abs(size->estimate(0)) <= kLinearShare &&
         sureSigmas(stage) * size->std(0) <= t.target_scale.bad;
}

Findings judgeDensity(const std::string& sensor, const ImuNoiseCheck& check,
                      const CalibrationRecord& record, const VerdictThresholds& t) {
  // The factor's relative deviation is 1 / sqrt(2 redundancy): a tenth at the bound.
  if (check.redundancy < kLeastRedundancy) return {};
  Rule rule{"Noise density of the " + sensor, "x", t.imu_noise_factor, adviceOnDensity(record)};
  VerdictLevel level = levelAbove(check.factor, rule.bound);
  // Too large a density biases nothing, it wastes information: never bad.
  if (check.factor < kPessimisticFactor) {
    rule.bound.caution = kPessimisticFactor;
    rule.advice =
        "The density in imu.yaml is larger than this recording needs: its inertial data are "
        "under-weighted.";
    // Within 3/2, for a stated density is seldom exactly what the data show.
    const bool may_be_degrees = std::abs(std::log(check.factor * kDegrees)) < std::log(1.5);
    if (sensor == "gyroscope" && may_be_degrees) {
      rule.advice += " If gyroscope_noise_density is in degrees, convert it to radians.";
    }
    level = VerdictLevel::kCaution;
  }
  return {finding(
      rule, level, check.factor,
      fmt::format("the residuals suggest {:.3g} times the assumed density (redundancy {:.0f})",
                  check.factor, check.redundancy))};
}

/// What a ruler and a look at the drivers can contradict: the length of the lever arm, the size of
/// the offset, and whether the cameras expose together.
Findings judgePlausibility(const CameraImuStageResult& stage, const VerdictThresholds& t) {
  Findings findings;
  const double arm = stage.imu.T_SC0.t.norm();
  findings.push_back(above({"Length of the lever arm", "m", t.lever_arm_m,
                            "Measure the distance between camera and IMU with a ruler: an "
                            "impossible lever arm means weak excitation or wrong axes."},
                           arm, fmt::format("camera 0 is {:.1f} mm from the IMU", 1e3 * arm)));
  const double offset = 1e3 * std::abs(stage.imu.timeOffset());
  findings.push_back(above({kOffsetSizeRule, "ms", t.offset_ms,
                            "Check how both sensors are stamped: offsets of this size come from "
                            "buffering or from stamps taken at arrival."},
                           offset,
                           fmt::format("t_imu = t_cam {:+.4f} ms", 1e3 * stage.imu.timeOffset())));
  if (auto finding = judgeSynchrony(stage, t)) findings.push_back(std::move(*finding));
  return findings;
}

Findings judgeFramesAndGaps(const CameraImuStageResult& stage, const VerdictThresholds& t) {
  const int without_imu = stage.frames_without_imu;
  const int without_pose = stage.frames_without_pose;
  // Of the frames with a pose; those without one are counted below.
  const auto posed = static_cast<double>(stage.frames.size()) + without_imu;
  return {above({"Frames covered by the IMU", "share", t.frames_without_imu,
                 "Start the IMU before the cameras and stop it after them, and look for pauses in "
                 "its driver: frames without IMU samples around them are not used."},
                share(without_imu, posed),
                fmt::format("{} of {:.0f} frames were not used because IMU samples are missing",
                            without_imu, posed)),
          above({"Gaps in the IMU's samples", "1", t.imu_gaps,
                 "Frames are not linked across a gap, which costs information only; find out why "
                 "samples were lost (driver, bus load, disk)."},
                stage.imu_gaps,
                fmt::format("number of gaps: {}{}", stage.imu_gaps, pausesIn(stage.screening))),
          above({"Frames without a pose (camera-IMU)", "share", t.rejected,
                 "That many frames without a plausible pose indicate false detections or "
                 "intrinsics that do not belong to these cameras."},
                share(without_pose, posed + without_pose),
                fmt::format("{} of {:.0f} frames gave no plausible pose", without_pose,
                            posed + without_pose))};
}

Findings judgeSampling(const CameraImuStageResult& stage) {
  constexpr double kLeastHz = 50;
  if (!(stage.imu_rate_hz > 0) || stage.imu_rate_hz >= kLeastHz) return {};
  return {
      finding({"Rate of the IMU for a hand's motion",
               "Hz",
               {kLeastHz, 0},
               "Record the IMU at 100 Hz or more: what a hand does between so few samples is not "
               "known, and other findings on the IMU may be of this alone."},
              VerdictLevel::kCaution, stage.imu_rate_hz,
              fmt::format("samples come at {:.4g} Hz", stage.imu_rate_hz))};
}

Findings judgeStatements(const CalibrationRecord& record, const VerdictThresholds& t) {
  Findings findings;
  const CameraImuStageResult& stage = *record.camera_imu;
  const double stated_hz = stage.imu.noise.rate_hz;
  if (stage.imu_rate_hz > 0 && stated_hz > 0) {
    findings.push_back(
        above({"Rate of the IMU", "share", t.imu_rate,
               "Correct update_rate in imu.yaml, or look for samples that were lost."},
              std::abs(stage.imu_rate_hz / stated_hz - 1),
              fmt::format("samples come at {:.4g} Hz, imu.yaml states {:.4g} Hz", stage.imu_rate_hz,
                          stated_hz)));
  }
  append(findings, judgeLinearFit(stage, record.assumptions.gravity_m_s2, t));
  if (auto finding = judgeTargetSize(stage, t)) findings.push_back(std::move(*finding));
  return findings;
}

}  // namespace plumbline
