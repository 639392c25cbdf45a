// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
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
  std::string what;  ///< of the faulty thing
  double scale;      ///< from the estimate's unit to the one shown
  std::string unit;
  std::string cure;
};

FaultWords wordsOf(UnmodelledFault fault) {
  constexpr double kPercent = 100;
  switch (fault) {
    case UnmodelledFault::kAccelScale:
      return {"scale error of the accelerometer's axes x, y, z", kPercent, "%",
              "calibrate the accelerometer's scale (at rest in six attitudes) and divide the "
              "columns of imu0/data.csv by 1 + error; check its range and unit"};
    case UnmodelledFault::kAccelMisalignment:
      return {
          "misalignment of the accelerometer's axes xy, xz, yx, yz, zx, zy", kDegrees, "deg",
          "calibrate the accelerometer's axes; accelerometer and gyroscope must be given in one "
          "right-angled frame"};
    case UnmodelledFault::kGyroScale:
      return {
          "scale error of the gyroscope's axes x, y, z", kPercent, "%",
          "calibrate the gyroscope's scale and divide the columns of imu0/data.csv by 1 + error"};
    case UnmodelledFault::kGyroMisalignment:
      return {"misalignment of the gyroscope's axes xy, xz, yx, yz, zx, zy", kDegrees, "deg",
              "calibrate the gyroscope's axes; accelerometer and gyroscope must be given in one "
              "right-angled frame"};
    case UnmodelledFault::kGSensitivity:
      return {"sensitivity of the gyroscope to acceleration, row by row", 1e3, "mrad/s per m/s^2",
              "compensate it (rate - G x acceleration), or use an IMU that is less sensitive"};
    case UnmodelledFault::kImuDelay:
      return {
          "delay of the accelerometer against the gyroscope", 1e3, "ms",
          "shift the accelerometer's stamps by it (check the filters of both: a low-pass delays)"};
    case UnmodelledFault::kClockDrift:
      return {"drift of the IMU's clock against the cameras'", 1e6, "ppm",
              "stamp both by one clock, or remove the drift from the stamps before calibrating"};
    case UnmodelledFault::kLineDelay:
      return {"readout time of the image (rolling shutter)", 1e3, "ms",
              "use a global shutter, or record slow motion: rolling shutters are not modelled"};
    case UnmodelledFault::kTargetSize:
      return {"size of the target, beyond what target.yaml states", kPercent, "%",
              "measure a tag's black square and the gap between tags, and correct tagSize or "
              "tagSpacing"};
    case UnmodelledFault::kCameraDelay:
      return {"exposure later than camera 0's under equal stamps", 1e3, "ms",
              "trigger the cameras together, or correct the camera's stamps"};
    case UnmodelledFault::kImuMoved:
      return {"change of T_SC0 (tx, ty, tz, rx, ry, rz)", 1e3, "mm, mrad",
              "mount IMU and camera rigidly and record again; or calibrate the parts before and "
              "after apart"};
    case UnmodelledFault::kClockStep:
      return {
          "step of the time offset", 1e3, "ms",
          "look for a clock that was set or a driver that restarted; calibrate the parts apart"};
    case UnmodelledFault::kCameraMoved:
      return {"change of the camera's pose in camera 0 (tx, ty, tz, rx, ry, rz)", 1e3, "mm, mrad",
              "mount the cameras rigidly and record again; or calibrate the parts before and after "
              "apart"};
  }
  return {};
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

std::string sentence(const FaultTest& test, TimeNs begin) {
  const FaultWords words = wordsOf(test.fault);
  std::string text = words.what;
  if (test.camera >= 0) text += fmt::format(" of cam{}", test.camera);
  if (test.since) text += fmt::format(" from {:.0f} s on", secondsBetween(begin, *test.since));
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
