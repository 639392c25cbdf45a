// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/results.h"
#include "evaluate/metrics/rules/rules.h"

namespace plumbline {
namespace {

/// How the estimate of a fault reads, and what mends it.
struct FaultWords {
  UnmodelledFault fault;
  const char* what;  ///< of the faulty thing
  double scale;      ///< from the estimate's unit to the one shown
  const char* unit;
  const char* cure;
};

constexpr double kPercent = 100;

const FaultWords kFaultWords[] = {
    {UnmodelledFault::kAccelScale, "scale error of the accelerometer's axes x, y, z", kPercent, "%",
     "calibrate the accelerometer's scale (at rest in six attitudes) and divide the "
     "columns of imu0/data.csv by 1 + error; check its range and unit"},
    {UnmodelledFault::kAccelMisalignment,

     "misalignment of the accelerometer's axes xy, xz, yx, yz, zx, zy", kDegrees, "deg",
     "calibrate the accelerometer's axes; accelerometer and gyroscope must be given in one "
     "right-angled frame"},
    {UnmodelledFault::kGyroScale,

     "scale error of the gyroscope's axes x, y, z", kPercent, "%",
     "calibrate the gyroscope's scale and divide the columns of imu0/data.csv by 1 + error"},
    {UnmodelledFault::kGyroMisalignment,
     "misalignment of the gyroscope's axes xy, xz, yx, yz, zx, zy", kDegrees, "deg",
     "calibrate the gyroscope's axes; accelerometer and gyroscope must be given in one "
     "right-angled frame"},
    {UnmodelledFault::kGSensitivity, "sensitivity of the gyroscope to acceleration, row by row",
     1e3, "mrad/s per m/s^2",
     "compensate it (rate - G x acceleration), or use an IMU that is less sensitive"},
    {UnmodelledFault::kImuDelay,

     "delay of the accelerometer against the gyroscope", 1e3, "ms",
     "shift the accelerometer's stamps by it (check the filters of both: a low-pass delays)"},
    {UnmodelledFault::kClockDrift, "drift of the IMU's clock against the cameras'", 1e6, "ppm",
     "stamp both by one clock, or remove the drift from the stamps before calibrating"},
    {UnmodelledFault::kLineDelay, "readout time of the image (rolling shutter)", 1e3, "ms",
     "use a global shutter, or record slow motion: rolling shutters are not modelled"},
    {UnmodelledFault::kTargetSize, "size of the target, beyond what target.yaml states", kPercent,
     "%",
     "measure a tag's black square and the gap between tags, and correct tagSize or "
     "tagSpacing"},
    {UnmodelledFault::kCameraDelay, "exposure later than camera 0's under equal stamps", 1e3, "ms",
     "trigger the cameras together, or correct the camera's stamps"},
    {UnmodelledFault::kImuMoved, "change of T_SC0 (tx, ty, tz, rx, ry, rz)", 1e3, "mm, mrad",
     "mount IMU and camera rigidly and record again; or calibrate the parts before and "
     "after apart"},
    {UnmodelledFault::kClockStep,

     "step of the time offset", 1e3, "ms",
     "look for a clock that was set or a driver that restarted; calibrate the parts apart"},
    {UnmodelledFault::kCameraMoved,
     "change of the camera's pose in camera 0 (tx, ty, tz, rx, ry, rz)", 1e3, "mm, mrad",
     "mount the cameras rigidly and record again; or calibrate the parts before and after "
     "apart"},
    {UnmodelledFault::kTargetShape,
     "shape of the target (it is not flat, or not even): RMS displacement of its corners", 1e3,
     "mm",
     "mount the target on a rigid flat plate (glass, aluminium), print it again without "
     "scaling one axis, and record again"},
    {UnmodelledFault::kTargetMoved, "displacement of the target along x, y, z of itself", 1e3, "mm",
     "fix the target and record again; or calibrate the parts before and after apart "
     "(--from, --to)"},
    {UnmodelledFault::kTargetSways,
     "swinging of the target (sine along x, y, z; cosine along x, y, z)", 1e3, "mm",
     "fix the target to something that does not move, and record again"},
    {UnmodelledFault::kGyroBiasJump, "jump of the gyroscope's bias (x, y, z)", 1, "rad/s",
     "look for a sensor that was reset, switched its range or was knocked; calibrate the "
     "parts before and after apart (--from, --to)"},
    {UnmodelledFault::kAccelBiasJump, "jump of the accelerometer's bias (x, y, z)", 1, "m/s^2",
     "look for a sensor that was reset, switched its range or was knocked; calibrate the "
     "parts before and after apart (--from, --to)"},
    {UnmodelledFault::kStampsWander, "changes of the time offset every eighth of the recording",
     1e3, "ms",
     "look for frames or samples that were lost while the others were stamped evenly, and "
     "for clocks that run at different rates; use the stamps that the sensors give"},
};

const FaultWords& wordsOf(UnmodelledFault fault) {
  return *std::find_if(std::begin(kFaultWords), std::end(kFaultWords),
                       [&](const FaultWords& words) { return words.fault == fault; });
}

/// "+2.00, -0.01, +0.03 % (+- 0.01, 0.02, 0.01)".
std::string figures(const FaultTest& test, const FaultWords& words) {
  const auto list = [&](const Eigen::VectorXd& values, const char* form) {
    std::string out;
    for (const double value : values) {
      out += (out.empty() ? "" : ", ") + fmt::format(fmt::runtime(form), words.scale * value);
    }
    return out;
  };
  return fmt::format("{} {} (+- {})", list(test.estimate, "{:+.3g}"), words.unit,
                     list(test.std, "{:.1g}"));
}

/// The terms that are known to differ from zero: "z_xx -0.96, z_yy -1.02 mm (+- 0.03, 0.04)".
std::string shapeFigures(const FaultTest& test, const FaultWords& words) {
  constexpr double kKnown = 3;
  std::string terms, deviations;
  for (Eigen::Index k = 0; k < test.estimate.size(); ++k) {
    if (std::abs(test.estimate(k)) < kKnown * test.std(k)) continue;
    const char* comma = terms.empty() ? "" : ", ";
    terms += fmt::format("{}{} {:+.3g}", comma, kTargetTermNames.at(static_cast<std::size_t>(k)),
                         words.scale * test.estimate(k));
    deviations += fmt::format("{}{:.1g}", comma, words.scale * test.std(k));
  }
  return fmt::format("{} {} (+- {})", terms, words.unit, deviations);
}

std::string sentence(const FaultTest& test, TimeNs begin) {
  const FaultWords& words = wordsOf(test.fault);
  std::string text = words.what;
  if (test.camera >= 0) text += fmt::format(" of cam{}", test.camera);
  if (test.since) text += fmt::format(" from {:.1f} s on", secondsBetween(begin, *test.since));
  if (test.frequency_hz) text += fmt::format(" at {:.2f} Hz", *test.frequency_hz);
  if (test.fault == UnmodelledFault::kTargetShape) return text + ": " + shapeFigures(test, words);
  return fmt::format("{}: {}", text, figures(test, words));
}

std::string effect(const FaultTest& test) {
  return fmt::format(
      "modelling it would move T_SC0 by {:.2g} mm and {:.2g} deg, the time offset by {:.2g} ms",
      1e3 * test.shift.head<3>().norm(), kDegrees * test.shift.segment<3>(3).norm(),
      1e3 * std::abs(test.shift(6)));
}

/// The fault's largest effect in units of the deviations shown, which are the formal ones here.
double effectInSigma(const FaultTest& test, const FaultDiagnosis& diagnosis) {
  return test.shift.cwiseAbs().cwiseQuotient(diagnosis.formal_std).maxCoeff();
}

/// The recording has no single value of something that the calibration states one of.
bool contradictsStatedValue(UnmodelledFault fault) {
  switch (fault) {
    case UnmodelledFault::kClockDrift:
    case UnmodelledFault::kCameraDelay:
    case UnmodelledFault::kImuMoved:
    case UnmodelledFault::kClockStep:
    case UnmodelledFault::kCameraMoved:
    case UnmodelledFault::kTargetShape:
    case UnmodelledFault::kTargetMoved:
    case UnmodelledFault::kTargetSways:
    case UnmodelledFault::kGyroBiasJump:
    case UnmodelledFault::kAccelBiasJump:
    case UnmodelledFault::kStampsWander:
      return true;
    default:
      return false;
  }
}

Finding findingOf(const FaultTest& cause, const FaultDiagnosis& diagnosis, const Rule& rule,
                  const std::string& evidence) {
  const double sigma = effectInSigma(cause, diagnosis);
  VerdictLevel level = levelAbove(sigma, rule.bound);
  if (level == VerdictLevel::kGood && contradictsStatedValue(cause.fault)) {
    level = VerdictLevel::kCaution;
  }
  return finding(
      rule, level, sigma,
      fmt::format("{}; {} ({:.1f} of its standard deviations)", evidence, effect(cause), sigma));
}

}  // namespace

Findings judgeFaults(const CameraImuStageResult& stage, const VerdictThresholds& t) {
  Findings findings;
  if (!stage.faults) return findings;
  const FaultDiagnosis& diagnosis = *stage.faults;
  const TimeNs begin = stage.frames.front().t;
  if (diagnosis.causes.empty()) {
    double worst = 0;
    for (const FaultTest& test : diagnosis.tests) worst = std::max(worst, test.significance);
    Rule rule{"Faults that the calibration does not model", "sigma", t.fault_sigma, ""};
    findings.push_back(
        finding(rule, VerdictLevel::kGood, 0.0,
                fmt::format("none of {} tested is significant (largest {:.1f} sigma)",
                            diagnosis.tests.size(), std::max(0.0, worst))));
    return findings;
  }
  for (const FaultTest& cause : diagnosis.causes) {
    const bool first = &cause == &diagnosis.causes.front();
    std::string evidence = sentence(cause, begin);
    if (first) {
      evidence = fmt::format("best explanation of the residuals among {} faults tested: {}",
                             diagnosis.tests.size(), evidence);
    }
    std::string advice = wordsOf(cause.fault).cure;
    if (first && diagnosis.alternative) {
      evidence += "; or else " + sentence(*diagnosis.alternative, begin) +
                  ": this recording cannot tell the two apart";
    }
    const Rule rule{first ? "Unmodelled fault" : "Further unmodelled fault", "sigma", t.fault_sigma,
                    std::move(advice)};
    findings.push_back(findingOf(cause, diagnosis, rule, evidence));
  }
  return findings;
}

}  // namespace plumbline
