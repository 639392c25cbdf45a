// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/calibration/held_imu.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/statistics/statistics.h"
#include "calibrator/base/transform.h"
#include "evaluate/metrics/calibration/distances.h"
#include "evaluate/metrics/failure_text.h"
#include "evaluate/metrics/half_width.h"
#include "evaluate/metrics/lists.h"
#include "evaluate/metrics/rules/rules.h"
#include "report/records/shown_findings.h"

namespace plumbline {
namespace {

constexpr VerdictThresholds kUsualBounds;  // those of a calibration's own verdict

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

/// Beyond so many deviations of both sides together a difference is certain. Of eight clean
/// components one exceeds it by chance in 2 % of the recordings.
constexpr double kCertain = 3;

/// By Student's t, for robust variances have few degrees of freedom; of what is not known, certain.
double deviates(double difference, const EstimatedVariance& a, const EstimatedVariance& b) {
  return difference == 0 ? 0 : normalDeviate(difference, sumOf(a, b));
}

/// What is certain is no good result, however small; how bad it is goes by its size.
struct JudgedDifference {
  VerdictLevel level = VerdictLevel::kGood;
  VerdictLevel by_size = VerdictLevel::kGood;  ///< good: certain, but below the usual bounds

  /// `size` is of what differs by so many deviates.
  void add(double deviates, double size, const Bound& bound) {
    if (deviates <= kCertain) return;
    by_size = std::max(by_size, levelAbove(size, bound));
    level = std::max({level, VerdictLevel::kCaution, by_size});
  }
};

/// A camera's time offset less camera 0's, as a recording has it.
struct OffsetBetween {
  std::size_t camera = 0;
  double s = 0;
  EstimatedVariance variance;
};

/// Of every camera with an offset of its own; of one that is synchronised by the score test, which
/// says what its own would be. `offset` is the variance of camera 0's.
std::vector<OffsetBetween> offsetsBetween(const CameraImuStageResult& estimated,
                                          const EstimatedVariance& offset) {
  std::vector<OffsetBetween> out;
  const TimeOffsets& offsets = estimated.imu.time_offsets;
  for (std::size_t c = 1; c < offsets.size(); ++c) {
    // By camera 0's deviation, to which the same IMU and as many corners lead.
    if (hasOwnOffset(offsets, c)) out.push_back({c, offsets[c].s - offsets.front().s, offset});
  }
  if (!estimated.faults) return out;
  for (const FaultTest& test : estimated.faults->tests) {
    if (test.fault != UnmodelledFault::kCameraDelay) continue;
    // From the same blocks of time as camera 0's, and so with as many degrees of freedom.
    out.push_back({static_cast<std::size_t>(test.camera),
                   test.estimate(0),
                   {test.std(0) * test.std(0), offset.dof}});
  }
  return out;
}

/// The offsets between cameras that were held, which an estimate with one offset for synchronised
/// cameras does not contradict by itself. `of_offset` is the variance of camera 0's.
Findings judgeHeldBetween(const ImuCalibration& held, HeldOffset offset,
                          const CameraImuStageResult& estimated,
                          const EstimatedVariance& of_offset) {
  Rule rule{"Time offsets between cameras against this recording", "ms", kUsualBounds.offset_std_ms,
            ""};
  VerdictLevel worst = VerdictLevel::kGood;
  double value = 0;
  std::string list;
  for (const OffsetBetween& b : offsetsBetween(estimated, of_offset)) {
    const double held_s = held.timeOffset(b.camera) - held.timeOffset();
    const double off_ms = 1e3 * std::abs(held_s - b.s);
    // One that is held synchronised is stated, not estimated. Files do not state a deviation of the
    // others: they are taken to be as uncertain as the recording's.
    const bool is_own = hasOwnOffset(held.time_offsets, b.camera);
    const EstimatedVariance of_held = is_own ? b.variance : EstimatedVariance{};
    const std::string& name = estimated.cameras[b.camera].name;
    list += fmt::format("{}{} less {} {:+.3f} ms, estimated on this recording {:+.3f} (+- {:.1g})",
                        list.empty() ? "" : "; ", name, estimated.cameras.front().name,
                        1e3 * held_s, 1e3 * b.s, 1e3 * std::sqrt(b.variance.value + of_held.value));
    if (isLarger(off_ms, value)) value = off_ms;
    JudgedDifference judged;
    judged.add(deviates(held_s - b.s, b.variance, of_held), off_ms, rule.bound);
    if (judged.level == VerdictLevel::kGood) continue;
    worst = std::max(worst, judged.level);
    rule.advice += fmt::format(
        "{}{} timeshift_cam_imu of {}{}: on this recording it is that of {} {:+.3f} ms",
        rule.advice.empty() ? "" : "; ", offset == HeldOffset::kAssumed ? "state" : "correct", name,
        judged.by_size == VerdictLevel::kGood
            ? fmt::format(" where less than {:g} ms matter", rule.bound.caution)
            : "",
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
  const auto& faults = estimated.faults;
  if (faults && faults->alternative) {
    return "The recording contradicts them, and has a fault of which it does not tell which of two "
           "it is: see the verdict of plumbline calibrate on it first";
  }
  if (faults && findBy(faults->causes, &FaultTest::fault, UnmodelledFault::kGivenCameras)) {
    return "The cameras do not suit the recording's corners either, which alone moves T_SC0: "
           "calibrate the cameras on it first";
  }
  return "The recording contradicts them; the cause was not tested: cameras that are not those of "
         "the recording, another mounting, other conventions, or a fault of this recording (see "
         "the verdict of plumbline calibrate on it)";
}

/// Those that the file states. Both sides are estimates: one that states none is taken to be as
/// uncertain as the recording's.
ImuVariances statedVariances(const ImuCalibration& held, ImuVariances own) {
  for (std::size_t k = 0; held.T_SC0_std && k < 6; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const double std = (*held.T_SC0_std)[i];
    own[k] = {std * std, held.T_SC0_dof ? (*held.T_SC0_dof)[i] : EstimatedVariance{}.dof};
  }
  if (held.time_offset_std_s) {
    own[6] = {*held.time_offset_std_s * *held.time_offset_std_s,
              held.time_offset_dof.value_or(EstimatedVariance{}.dof)};
  }
  return own;
}

struct HeldDifference {
  JudgedDifference transform, offset;
  std::string evidence;
};

/// `own` are the variances of `seen`. Every component is judged by itself: a length is known as
/// badly as the worst of its components, which would hide the others.
HeldDifference heldDifference(const ImuCalibration& held, const ImuCalibration& seen,
                              const ImuVariances& own) {
  constexpr std::array kNames = {"T_SC0.tx", "T_SC0.ty", "T_SC0.tz",   "T_SC0.rx",
                                 "T_SC0.ry", "T_SC0.rz", "time offset"};
  const ImuVariances stated = statedVariances(held, own);
  Eigen::Matrix<double, kImuParameters, 1> off, variance, by;
  off << boxminus(held.T_SC0, seen.T_SC0), held.timeOffset() - seen.timeOffset();
  for (std::size_t k = 0; k < kImuParameters; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    variance[i] = own[k].value + stated[k].value;
    by[i] = deviates(off[i], own[k], stated[k]);
  }
  HeldDifference d;
  const auto judge = [&](int from, int count, double unit, const Bound& bound,
                         JudgedDifference& judged) {
    // Only what is certain: the others add what nobody knows.
    double squared = 0, most = 0;
    for (int i = from; i < from + count; ++i) {
      if (isLarger(by[i], most)) most = by[i];
      if (!(by[i] <= kCertain)) squared += off[i] * off[i];
    }
    judged.add(most, std::sqrt(squared) / unit, bound);
  };
  constexpr double kMillimetre = 1e-3, kMillisecond = 1e-3;
  judge(0, 3, 1, kUsualBounds.lever_arm_std_m, d.transform);
  judge(3, 3, kDegree, kUsualBounds.rotation_std_deg, d.transform);
  judge(6, 1, kMillisecond, kUsualBounds.offset_std_ms, d.offset);
  Eigen::Index most = 0;
  by.maxCoeff<Eigen::PropagateNaN>(&most);
  d.evidence = fmt::format(
      "estimated on this recording with the same cameras they differ by {:.1f} mm, {:.2f} deg and "
      "{:.2f} ms (+- {:.1g}, {:.1g}, {:.1g}), the most by {:.1f} deviations ({})",
      off.head<3>().norm() / kMillimetre, off.segment<3>(3).norm() / kDegree,
      std::abs(off[6]) / kMillisecond, std::sqrt(variance.head<3>().sum()) / kMillimetre,
      std::sqrt(variance.segment<3>(3).sum()) / kDegree, std::sqrt(variance[6]) / kMillisecond,
      by[most], kNames[static_cast<std::size_t>(most)]);
  return d;
}

}  // namespace

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
    f.value = std::numeric_limits<double>::quiet_NaN();
    f.evidence = (unobservable ? std::string(kNotJudgedWords) : "not tested: ") +
                 "on this recording they cannot be estimated with these cameras (" +
                 (estimated ? std::string("the batch did not converge")
                            : textOf(estimated.failure()).message) +
                 ")";
    return {f};
  }
  const ImuVariances own = imuVariances(*estimated);
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
        "What differs by more than three deviations is below {:g} mm, {:g} deg and {:g} ms: "
        "calibrate on this recording where that matters",
        1e3 * kUsualBounds.lever_arm_std_m.caution, kUsualBounds.rotation_std_deg.caution,
        kUsualBounds.offset_std_ms.caution);
  }
  Findings findings = judgeHeldBetween(held, offset, *estimated, own[6]);
  findings.insert(findings.begin(), std::move(f));
  return findings;
}

std::vector<Finding> testHeldImu(const Calibration& calibration, HeldOffset offset,
                                 const Session& session, const ScoreOptions& options) {
  if (!options.use_imu || !calibration.imu || !session.imu) return {};
  CameraImuOptions free = options.camera_imu;
  free.noise_check = false;
  // Its tests vary the lenses, of which some models can only be scored.
  free.diagnose_faults = canBeCalibrated(calibration);
  free.cameras_given = free.diagnose_faults;
  return judgeHeldImu(*calibration.imu, offset,
                      calibrateCameraImu(session, calibration.cameras, free));
}

}  // namespace plumbline
