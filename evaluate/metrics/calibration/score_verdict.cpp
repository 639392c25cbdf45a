// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "evaluate/metrics/calibration/score.h"
#include "evaluate/metrics/failure_text.h"
#include "evaluate/metrics/headline.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
namespace {

constexpr VerdictThresholds kUsual;  // those of a calibration's own verdict

void addUnscored(const std::vector<CalibrationScore>& scores, Findings& findings) {
  for (const CalibrationScore& s : scores) {
    if (s.problem.empty()) continue;
    // With corners scored only a part is missing (the IMU's, a fold's); without there is no score.
    Finding f{fmt::format("Score on {}, {}", s.session, s.part),
              s.reprojection.count > 0 ? VerdictLevel::kCaution : VerdictLevel::kBad, s.problem};
    if (s.part == "all" && s.problem.starts_with("camera-IMU")) {
      f.subject = FindingSubject::kExtrinsics;
    }
    findings.push_back(std::move(f));
  }
}

/// A recording that was given as held out, and is not: its score is one in sample, maybe.
Finding notHeldOut(const CalibrationScore& s) {
  Finding f{"Held-out recording " + s.session, VerdictLevel::kCaution,
            "is not held out: it is the first recording, or has the name or the content of the one "
            "that the calibration's file says it was estimated from",
            "give a recording that the calibration has not seen"};
  f.subject = FindingSubject::kRecording;
  return f;
}

/// RMSE of recordings and folds that the calibration has not seen; single folds are in their pool.
Findings judgeHeldOut(const std::vector<CalibrationScore>& scores) {
  Findings findings;
  for (const CalibrationScore& s : scores) {
    // "all" is a whole session, "all K folds" their pool; "fold k of K" are single ones.
    if (!s.part.starts_with("all") || s.reprojection.count == 0) continue;
    // Whole recordings behind the first were given as held out.
    const bool given = &s != &scores.front() && s.part == "all";
    if (given && !s.held_out) findings.push_back(notHeldOut(s));
    if (!given && !s.held_out) continue;
    const char* what = s.held_out ? "Held-out reprojection" : "Reprojection";
    findings.push_back(
        above({fmt::format("{} error on {}, {}", what, s.session, s.part), "px", kUsual.rmse_px,
               "Compare with the error in sample: where that is small, the calibration does not "
               "hold for other views of the rig; record more of the image and calibrate again."},
              s.reprojection.rmse_px,
              fmt::format("RMSE {:.3f} px over {} corners", s.reprojection.rmse_px,
                          s.reprojection.count)));
  }
  return findings;
}

/// The mistake of convention under which the held values are the recording's, as what to do; ""
/// where none explains them.
std::string mistakeOf(const ImuCalibration& held, const ImuCalibration& seen) {
  constexpr double kSameRotation = 0.05;     // [rad]
  constexpr double kSameTranslation = 0.02;  // [m]
  constexpr double kSameOffset = 2e-3;       // [s]
  const auto same = [&](const Transform& a) {
    return rotationAngle(a.R.transpose() * seen.T_SC0.R) < kSameRotation &&
           (a.t - seen.T_SC0.t).norm() < kSameTranslation;
  };
  const double offset = held.timeOffset(), seen_offset = seen.timeOffset();
  const auto same_offset = [&](double s) { return std::abs(s - seen_offset) < kSameOffset; };
  std::vector<std::string> mistakes;
  if (!same(held.T_SC0) && same(held.T_SC0.inverse())) {
    mistakes.emplace_back("its inverse agrees: invert T_cam_imu (T_SC0)");
  }
  // Near zero any offset agrees with its opposite, and with a thousandth of another.
  constexpr double kTellsSign = 2 * kSameOffset;
  constexpr double kLeastInMilliseconds = 0.5;  // no clock of a rig is off by so much
  if (std::abs(seen_offset) > kTellsSign && same_offset(-offset)) {
    mistakes.emplace_back("with the other sign the offset agrees: negate timeshift_cam_imu");
  } else if (std::abs(offset) > kLeastInMilliseconds && same_offset(1e-3 * offset)) {
    mistakes.emplace_back("in milliseconds the offset agrees: divide timeshift_cam_imu by 1000");
  }
  return joined(mistakes, "; ");
}

/// A camera's time offset less camera 0's, as a recording has it.
struct OffsetBetween {
  std::size_t camera = 0;
  double s = 0, std_s = 0;
};

/// Of every camera with an offset of its own; of one that is synchronised by the score test, which
/// says what its own would be.
std::vector<OffsetBetween> offsetsBetween(const CameraImuStageResult& estimated, double std_s) {
  std::vector<OffsetBetween> out;
  const TimeOffsets& offsets = estimated.imu.time_offsets;
  for (std::size_t c = 1; c < offsets.size(); ++c) {
    // By camera 0's deviation, to which the same IMU and as many corners lead.
    if (hasOwnOffset(offsets, c)) out.push_back({c, offsets[c].s - offsets.front().s, std_s});
  }
  if (!estimated.faults) return out;
  for (const FaultTest& test : estimated.faults->tests) {
    if (test.fault != UnmodelledFault::kCameraDelay) continue;
    out.push_back({static_cast<std::size_t>(test.camera), test.estimate(0), test.std(0)});
  }
  return out;
}

/// The offsets between cameras that were held, which an estimate with one offset for synchronised
/// cameras does not contradict by itself. `std_s` is of camera 0's offset.
Findings judgeHeldBetween(const ImuCalibration& held, HeldOffset offset,
                          const CameraImuStageResult& estimated, double std_s) {
  Rule rule{"Time offsets between cameras against this recording", "ms", kUsual.offset_std_ms, ""};
  VerdictLevel worst = VerdictLevel::kGood;
  double value = 0;
  std::string list;
  for (const OffsetBetween& b : offsetsBetween(estimated, std_s)) {
    const double held_s = held.timeOffset(b.camera) - held.timeOffset();
    const double off_ms = 1e3 * std::abs(held_s - b.s);
    const std::string& name = estimated.cameras[b.camera].name;
    list += fmt::format("{}{} less {} {:+.3f} ms, estimated on this recording {:+.3f} (+- {:.1g})",
                        list.empty() ? "" : "; ", name, estimated.cameras.front().name,
                        1e3 * held_s, 1e3 * b.s, 1e3 * b.std_s);
    if (isLarger(off_ms, value)) value = off_ms;
    const VerdictLevel level =
        off_ms <= 3e3 * b.std_s ? VerdictLevel::kGood : levelAbove(off_ms, rule.bound);
    if (level == VerdictLevel::kGood) continue;
    worst = std::max(worst, level);
    rule.advice += fmt::format(
        "{}{} timeshift_cam_imu of {}: on this recording it is that of {} {:+.3f} ms",
        rule.advice.empty() ? "" : "; ", offset == HeldOffset::kAssumed ? "state" : "correct", name,
        estimated.cameras.front().name, 1e3 * b.s);
  }
  if (list.empty()) return {};
  // Another fault of the recording may look like a delay of a camera.
  const bool other =
      estimated.faults && std::any_of(estimated.faults->causes.begin(),
                                      estimated.faults->causes.end(), [](const FaultTest& cause) {
                                        return cause.fault != UnmodelledFault::kCameraDelay;
                                      });
  if (offset == HeldOffset::kAssumed || other) worst = std::min(worst, VerdictLevel::kCaution);
  Finding f = finding(rule, worst, value, list);
  f.subject = FindingSubject::kExtrinsics;
  return {f};
}

/// What to do where `estimated` contradicts what was held.
std::string contradictionAdvice(const ImuCalibration& held, const CameraImuStageResult& estimated) {
  if (std::string mistake = mistakeOf(held, estimated.imu); !mistake.empty()) return mistake;
  if (estimated.faults &&
      findBy(estimated.faults->causes, &FaultTest::fault, UnmodelledFault::kGivenCameras)) {
    return "The cameras do not suit the recording's corners either, which alone moves T_SC0: "
           "calibrate the cameras on it first";
  }
  return "The recording contradicts them; the cause was not tested: cameras that are not those of "
         "the recording, another mounting, other conventions, or a fault of this recording (see "
         "the verdict of plumbline calibrate on it)";
}

/// "0.36 px RMSE on euroc (0.40 px with the IMU), 0.37 px in all 5 folds (held out)".
std::string scoreWords(const std::vector<CalibrationScore>& scores) {
  std::string text;
  for (const CalibrationScore& s : scores) {
    const bool pooled = s.part.starts_with("all");
    if (!pooled || s.reprojection.count == 0) continue;
    // In-sample errors of the folds say nothing that the whole session's do not.
    if (s.part != "all" && !s.held_out) continue;
    text += fmt::format("{}{:.2f} px RMSE {} {}", text.empty() ? "" : ", ", s.reprojection.rmse_px,
                        s.part == "all" ? "on" : "in", s.part == "all" ? s.session : s.part);
    if (s.camera_imu) text += fmt::format(" ({:.2f} px with the IMU)", s.camera_imu->rmse_px);
    if (s.held_out) text += ", held out";
  }
  return text;
}

using Deviations7 = Eigen::Matrix<double, 7, 1>;  // T_SC0 (3 m, 3 rad), time offset [s]

/// By formal deviations alone, what the recording's own unmodelled errors do to T_SC0 would be
/// called a contradiction.
Deviations7 deviationsOf(const CameraImuStageResult& estimated) {
  Deviations7 std;
  std << *estimated.imu.T_SC0_std, *estimated.imu.time_offset_std_s;
  return estimated.faults ? Deviations7(std.cwiseMax(estimated.faults->robust_std)) : std;
}

/// Beyond what chance explains nothing is good; how bad it is goes by its size.
struct JudgedDifference {
  VerdictLevel level = VerdictLevel::kGood;
  VerdictLevel by_size = VerdictLevel::kGood;  ///< good: certain, but below the usual bounds

  void add(double off, double deviation, const Bound& bound) {
    if (off <= 3 * deviation) return;
    by_size = std::max(by_size, levelAbove(off, bound));
    level = std::max({level, VerdictLevel::kCaution, by_size});
  }
};

struct HeldDifference {
  JudgedDifference transform, offset;
  std::string evidence;
};

/// `own` are the deviations of `seen`. Both sides are estimates: a file that states none is taken
/// to be as uncertain as the recording's. A vector's deviation is the root of its components'
/// summed variances, the RMS of its length.
HeldDifference heldDifference(const ImuCalibration& held, const ImuCalibration& seen,
                              const Deviations7& own) {
  Deviations7 stated;
  stated << held.T_SC0_std.value_or(Vector6d(own.head<6>())),
      held.time_offset_std_s.value_or(own(6));
  const Deviations7 std = (own.cwiseAbs2() + stated.cwiseAbs2()).cwiseSqrt();
  const double lever_m = (held.T_SC0.t - seen.T_SC0.t).norm();
  const double angle_deg = rotationAngle(held.T_SC0.R.transpose() * seen.T_SC0.R) / kDegree;
  const double offset_ms = 1e3 * std::abs(held.timeOffset() - seen.timeOffset());
  const double lever_std_m = std.head<3>().norm();
  const double angle_std_deg = std.segment<3>(3).norm() / kDegree;
  HeldDifference d;
  d.transform.add(lever_m, lever_std_m, kUsual.lever_arm_std_m);
  d.transform.add(angle_deg, angle_std_deg, kUsual.rotation_std_deg);
  d.offset.add(offset_ms, 1e3 * std(6), kUsual.offset_std_ms);
  d.evidence = fmt::format(
      "estimated on this recording with the same cameras they differ by {:.1f} mm, {:.2f} deg and "
      "{:.2f} ms (+- {:.1g}, {:.1g}, {:.1g})",
      1e3 * lever_m, angle_deg, offset_ms, 1e3 * lever_std_m, angle_std_deg, 1e3 * std(6));
  return d;
}

}  // namespace

Finding unusedShape(const std::string& file) {
  Finding f{"Shape of the target", VerdictLevel::kCaution,
            "the board is assumed to be as target.yaml states, but " + file +
                " lies beside the calibration",
            "if the calibration was estimated with that shape, and this recording shows the same "
            "board, run again with --target-shape " +
                file};
  f.subject = FindingSubject::kRecording;
  return f;
}

std::vector<Finding> judgeHeldImu(const ImuCalibration& held, HeldOffset offset,
                                  const Result<CameraImuStageResult>& estimated) {
  Finding f;
  f.rule = "T_SC0 and time offset against this recording";
  f.subject = FindingSubject::kExtrinsics;
  if (!estimated || !estimated->summary.converged) {
    // A recording that moves too little to tell is no fault of the calibration.
    const bool unobservable =
        !estimated && estimated.failure().reason() == FailureReason::kNotObservable;
    f.level = unobservable ? VerdictLevel::kGood : VerdictLevel::kCaution;
    f.evidence = "not tested: on this recording they cannot be estimated with these cameras (" +
                 (estimated ? std::string("the batch did not converge")
                            : textOf(estimated.failure()).message) +
                 ")";
    return {f};
  }
  const Deviations7 own = deviationsOf(*estimated);
  const HeldDifference d = heldDifference(held, estimated->imu, own);
  // A file cannot contradict the recording in an offset that it does not state.
  const bool assumed = offset == HeldOffset::kAssumed;
  f.level = std::max(d.transform.level,
                     assumed ? std::min(d.offset.level, VerdictLevel::kCaution) : d.offset.level);
  f.evidence = d.evidence;
  if (assumed) f.evidence += "; the file states no time offset, and 0 was taken";
  // Only the 0 that was taken can be off by more than a little: then there is no mistake of
  // convention to look for.
  const bool wrong = d.transform.by_size != VerdictLevel::kGood ||
                     (!assumed && d.offset.by_size != VerdictLevel::kGood);
  if (wrong) {
    f.advice = contradictionAdvice(held, *estimated);
  } else if (assumed && d.offset.level != VerdictLevel::kGood) {
    f.advice = fmt::format(
        "State the time offset in the file (timeshift_cam_imu); this recording's is {:.3f} ms",
        1e3 * estimated->imu.timeOffset());
  } else if (f.level != VerdictLevel::kGood) {
    f.advice = fmt::format(
        "More than three deviations, but below {:g} mm, {:g} deg and {:g} ms: calibrate on this "
        "recording where that matters",
        1e3 * kUsual.lever_arm_std_m.caution, kUsual.rotation_std_deg.caution,
        kUsual.offset_std_ms.caution);
  }
  Findings findings = judgeHeldBetween(held, offset, *estimated, own(6));
  findings.insert(findings.begin(), std::move(f));
  return findings;
}

std::vector<Finding> judgeScored(const std::optional<CameraStageResult>& camera,
                                 const std::optional<CameraImuStageResult>& camera_imu) {
  Findings findings;
  const auto add = [&](const auto& stage, const char* name, FindingSubject subject,
                       const char* advice) {
    if (!stage) return;
    Findings errors =
        judgeResiduals({stage->residuals, stage->summary, stage->cameras}, name, kUsual);
    // The rules' own advice is to who calibrates.
    for (Finding& f : errors) f.advice = f.advice.empty() ? "" : advice;
    append(findings, std::move(errors), subject);
  };
  add(camera, "cameras", FindingSubject::kCameras,
      "Poses of their own do not explain the corners: the cameras are not those of this recording, "
      "their lens model does not fit, or corners and board are at fault (blur, a bent target). "
      "Calibrate a recording of this rig and see its verdict.");
  add(camera_imu, "camera-IMU", FindingSubject::kExtrinsics,
      "Compare with the error of the cameras alone: where that is small, T_SC0, the time offset or "
      "the IMU contradict the cameras.");
  return findings;
}

Verdict scoreVerdict(const CalibrationRecord& record, const std::string& unused_shape,
                     const std::vector<Finding>& held_imu) {
  Findings findings = judgeScored(record.camera, record.camera_imu);
  append(findings, held_imu, FindingSubject::kExtrinsics);
  append(findings, judgeHeldOut(record.held->scores));
  addUnscored(record.held->scores, findings);
  if (!unused_shape.empty()) findings.push_back(unusedShape(unused_shape));
  Verdict verdict = makeVerdict(std::move(findings));
  verdict.headline = fmt::format("{}: {}; only poses are estimated.", record.held->file,
                                 scoreWords(record.held->scores));
  if (const std::string worst = worstFinding(verdict); !worst.empty()) {
    verdict.headline += " " + worst;
  }
  return verdict;
}

}  // namespace plumbline
