// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/results.h"
#include "calibrator/batch/camera_imu/stage.h"
#include "evaluate/metrics/rules/fault_text.h"
#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
namespace {

/// `shift` is what modelling the fault changes: T_SC0's translation [m], its rotation in the left
/// tangent [rad], and the time offset [s].
std::string effect(const FaultTest& test) {
  return fmt::format(
      "modelling it would change T_SC0 by {:.2g} mm and {:.2g} deg, the time offset by {:.2g} ms",
      1e3 * test.shift.head<3>().norm(), kDegrees * test.shift.segment<3>(3).norm(),
      1e3 * std::abs(test.shift(6)));
}

/// A fault's largest effect in formal standard deviations (the smaller ones, so that doubt comes
/// early), and on which of T_SC0 and the time offset.
struct LargestEffect {
  double sigma = 0;
  std::size_t parameter = 0;
};

LargestEffect largestEffect(const FaultTest& test, const FaultDiagnosis& diagnosis) {
  Eigen::Index place = 0;
  const double sigma = test.shift.cwiseAbs().cwiseQuotient(diagnosis.formal_std).maxCoeff(&place);
  return {sigma, static_cast<std::size_t>(place)};
}

/// "up to 38.5 formal standard deviations, in T_SC0.rx".
std::string sigmaWords(const LargestEffect& effect) {
  static constexpr std::array kNames{"T_SC0.tx", "T_SC0.ty", "T_SC0.tz",   "T_SC0.rx",
                                     "T_SC0.ry", "T_SC0.rz", "time_offset"};
  return fmt::format("up to {:.1f} formal standard deviations, in {}", effect.sigma,
                     kNames[effect.parameter]);
}

/// The recording has no single value of something that the calibration states one of.
bool contradictsStatedValue(UnmodelledFault fault) {
  using Fault = UnmodelledFault;
  constexpr std::array kOfNoSingleValue{
      Fault::kClockDrift,   Fault::kCameraDelay,   Fault::kImuMoved,     Fault::kClockStep,
      Fault::kCameraMoved,  Fault::kTargetShape,   Fault::kTargetMoved,  Fault::kTargetSways,
      Fault::kGyroBiasJump, Fault::kAccelBiasJump, Fault::kStampsWander, Fault::kSoftMount,
      Fault::kImuDelay};  // gyroscope and accelerometer have time offsets of their own
  return std::find(kOfNoSingleValue.begin(), kOfNoSingleValue.end(), fault) !=
         kOfNoSingleValue.end();
}

/// An effect on the calibration, and where it is caution and bad.
struct Effect {
  double value = 0;
  const char* unit;
  Bound bound;
};

/// Of cameras that were given the effect counts in robust deviations, since those of other
/// recordings differ by more than formal ones, and in the units of the calibration, by the bounds
/// on its deviations.
Effect worstEffect(const FaultTest& cause, double sigma, const VerdictThresholds& t) {
  Effect worst{sigma, "sigma", t.fault_sigma};
  if (cause.fault != UnmodelledFault::kGivenCameras) return worst;
  worst.value = cause.shift_sigma;
  for (const Effect& effect :
       {Effect{cause.shift.head<3>().norm(), "m", t.lever_arm_std_m},
        Effect{kDegrees * cause.shift.segment<3>(3).norm(), "deg", t.rotation_std_deg},
        Effect{1e3 * std::abs(cause.shift(6)), "ms", t.offset_std_ms}}) {
    if (levelAbove(effect.value, effect.bound) > levelAbove(worst.value, worst.bound)) {
      worst = effect;
    }
  }
  return worst;
}

/// The level is by the effect on the calibration, not by the test's significance: a fault that is
/// certain and moves nothing is good, unless what the calibration states has no single value.
Finding findingOf(const FaultTest& cause, const FaultDiagnosis& diagnosis, const std::string& name,
                  const std::string& evidence, const std::string& advice,
                  const VerdictThresholds& t) {
  const LargestEffect largest = largestEffect(cause, diagnosis);
  const bool first = &cause == &diagnosis.causes.front();
  Effect effect_of = worstEffect(cause, largest.sigma, t);
  VerdictLevel level = levelAbove(effect_of.value, effect_of.bound);
  // Which of two it is nobody knows, and the other may not be harmless: the gyroscope's axes move
  // T_SC0, the accelerometer's do not.
  std::string of_other;
  if (first && diagnosis.alternative && level == VerdictLevel::kGood) {
    const FaultTest& other = *diagnosis.alternative;
    const LargestEffect of_it = largestEffect(other, diagnosis);
    const Effect worse = worstEffect(other, of_it.sigma, t);
    if (levelAbove(worse.value, worse.bound) != VerdictLevel::kGood) {
      effect_of = worse;
      level = VerdictLevel::kCaution;
      of_other = fmt::format("; of the alternative: {} ({})", effect(other), sigmaWords(of_it));
    }
  }
  if (level == VerdictLevel::kGood && contradictsStatedValue(cause.fault)) {
    level = VerdictLevel::kCaution;
  }
  return finding(
      {name, effect_of.unit, effect_of.bound, advice}, level, effect_of.value,
      fmt::format("{}; {} ({}){}{}", evidence, effect(cause), sigmaWords(largest), of_other,
                  first ? fmt::format("; it explains the residuals best among {} faults tested",
                                      std::ranges::count_if(diagnosis.tests, isTested))
                        : ""));
}

/// Where nothing was tested, nothing speaks for the stated deviations: a caution. Tests of a short
/// recording would find chance; one that is long enough had them refused by the solution, whose
/// deviations are those of an optimum.
Finding untestedFaults(const CalibrationRecord& record, Rule rule) {
  const std::string also =
      record.camera ? "" : "; the given cameras were not tested on this recording either";
  if (!areDiagnosed(record.camera_imu->frames)) {
    rule.advice =
        "Faults that bias T_SC0 by many of its deviations pass unseen in so short a recording: "
        "record 10 s or more.";
    return finding(rule, VerdictLevel::kCaution, std::numeric_limits<double>::quiet_NaN(),
                   "not tested: the tests need at least 8 s in which the target is seen" + also);
  }
  rule.advice =
      "Standard deviations hold at an optimum only, and faults that bias T_SC0 were not looked "
      "for: record again with brisk rotations and translations in all directions.";
  return finding(rule, VerdictLevel::kCaution, std::numeric_limits<double>::quiet_NaN(),
                 "not tested: the solver stopped off the optimum, or the system there has no "
                 "inverse" +
                     also);
}

}  // namespace

Findings judgeFaults(const CalibrationRecord& record, const VerdictThresholds& t) {
  Findings findings;
  const CameraImuStageResult& stage = *record.camera_imu;
  const Rule rule{"Faults that the calibration does not model", "sigma", t.fault_sigma, ""};
  if (!stage.faults) return {untestedFaults(record, rule)};
  const FaultDiagnosis& diagnosis = *stage.faults;
  if (diagnosis.causes.empty()) {
    // The rule compares effects on the calibration, of which there are none: its value is 0, and
    // the largest significance is evidence alone.
    double worst = 0;
    for (const FaultTest& test : diagnosis.tests) worst = std::max(worst, test.significance);
    findings.push_back(
        finding(rule, VerdictLevel::kGood, 0.0,
                fmt::format("none of {} tested is significant (largest {:.1f} sigma){}",
                            std::ranges::count_if(diagnosis.tests, isTested), std::max(0.0, worst),
                            notTested(diagnosis.tests))));
    return findings;
  }
  for (const FaultTest& cause : diagnosis.causes) {
    const bool first = &cause == &diagnosis.causes.front();
    findings.push_back(first ? findingOf(cause, diagnosis, "Unmodelled fault",
                                         firstCause(diagnosis, stage), firstCure(diagnosis), t)
                             : findingOf(cause, diagnosis, "Further unmodelled fault",
                                         faultText(cause, stage), cureOf(cause), t));
  }
  return findings;
}

}  // namespace plumbline
