// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "calibrator/base/results.h"
#include "calibrator/batch/camera_imu/stage.h"
#include "evaluate/metrics/lists.h"
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
  std::span<const char* const> names = {};  ///< of the components; empty: there is one
};

constexpr double kPercent = 100;
constexpr const char* kAxes[] = {"x", "y", "z"};
constexpr const char* kPairs[] = {"xy", "xz", "yx", "yz", "zx", "zy"};
constexpr const char* kMatrix[] = {"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};
constexpr const char* kPose[] = {"tx", "ty", "tz", "rx", "ry", "rz"};
constexpr const char* kEighths[] = {"at 1/8", "at 2/8", "at 3/8", "at 4/8",
                                    "at 5/8", "at 6/8", "at 7/8"};
constexpr const char* kWaves[] = {"sine x", "sine y", "sine z", "cosine x", "cosine y", "cosine z"};

const FaultWords kFaultWords[] = {
    {UnmodelledFault::kAccelScale, "scale error of the accelerometer", kPercent, "%",
     "calibrate the accelerometer's scale (at rest in six attitudes) and divide the columns of "
     "imu0/data.csv by 1 + error; check its range and unit",
     kAxes},
    {UnmodelledFault::kAccelMisalignment, "misalignment of the accelerometer's axes", kDegrees,
     "deg",
     "calibrate the accelerometer's axes; accelerometer and gyroscope must be given in one "
     "orthogonal frame (with the accelerometer corrected, T_SC0 is in the gyroscope's frame)",
     kPairs},
    {UnmodelledFault::kGyroScale, "scale error of the gyroscope", kPercent, "%",
     "calibrate the gyroscope's scale and divide the columns of imu0/data.csv by 1 + error", kAxes},
    {UnmodelledFault::kGyroMisalignment, "misalignment of the gyroscope's axes", kDegrees, "deg",
     "calibrate the gyroscope's axes; accelerometer and gyroscope must be given in one orthogonal "
     "frame (with the gyroscope corrected, T_SC0 is in the accelerometer's frame)",
     kPairs},
    {UnmodelledFault::kGSensitivity, "g-sensitivity of the gyroscope", 1e3, "mrad/s per m/s^2",
     "compensate it (rate - G x acceleration), or use an IMU that is less sensitive", kMatrix},
    {UnmodelledFault::kImuDelay, "delay of the accelerometer against the gyroscope", 1e3, "ms",
     "shift the accelerometer's stamps by it (check the filters of both: a low-pass delays)"},
    {UnmodelledFault::kClockDrift, "drift of the IMU's clock against the cameras'", 1e6, "ppm",
     "stamp both by one clock, or remove the drift from the stamps before calibrating"},
    {UnmodelledFault::kLineDelay, "readout time of the image (rolling shutter)", 1e3, "ms",
     "use a global shutter, or record slow motion: rolling shutters are not modelled"},
    {UnmodelledFault::kTargetSize, "size of the target, beyond what target.yaml states", kPercent,
     "%",
     "measure a tag's black square and the gap between tags, and correct tagSize or tagSpacing"},
    {UnmodelledFault::kCameraDelay, "exposure later than camera 0's under equal stamps", 1e3, "ms",
     "trigger the cameras together, or correct the camera's stamps"},
    {UnmodelledFault::kImuMoved, "change of T_SC0", 1e3, "mm",
     "mount IMU and camera rigidly and record again; or calibrate the parts before and after "
     "separately",
     kPose},
    {UnmodelledFault::kClockStep, "step of the time offset", 1e3, "ms",
     "look for a clock that was set or a driver that restarted; calibrate the parts separately"},
    {UnmodelledFault::kCameraMoved, "change of the camera's pose in camera 0", 1e3, "mm",
     "mount the cameras rigidly and record again; or calibrate the parts before and after "
     "separately",
     kPose},
    // Of these names the last, tag_edge, is not tested: it is the detector's rather than the
    // board's.
    {UnmodelledFault::kTargetShape,
     "shape of the target (not flat, or grid not even): RMS displacement of its corners", 1e3, "mm",
     "mount the target on a rigid flat plate (glass, aluminium), print it again without scaling "
     "one axis, and record again",
     kTargetTermNames},
    {UnmodelledFault::kTargetMoved, "displacement of the target along its own axes", 1e3, "mm",
     "fix the target and record again; or calibrate the parts before and after separately (--from, "
     "--to)",
     kAxes},
    {UnmodelledFault::kTargetSways, "swinging of the target", 1e3, "mm",
     "fix the target to something that does not move, and record again", kWaves},
    {UnmodelledFault::kGyroBiasJump, "jump of the gyroscope's bias", 1, "rad/s",
     "look for a sensor that was reset, switched its range or was knocked; calibrate the parts "
     "before and after separately (--from, --to)",
     kAxes},
    {UnmodelledFault::kAccelBiasJump, "jump of the accelerometer's bias", 1, "m/s^2",
     "look for a sensor that was reset, switched its range or was knocked; calibrate the parts "
     "before and after separately (--from, --to)",
     kAxes},
    {UnmodelledFault::kStampsWander, "changes of the time offset every eighth of the recording",
     1e3, "ms",
     "look for lost frames or samples that evenly spaced stamps hide, and for clocks that run at "
     "different rates; use the sensors' own stamps",
     kEighths},
    // Named camera by camera: shownOf().
    {UnmodelledFault::kGivenCameras, "the given cameras do not suit this recording's corners", 1,
     "px",
     "refine the cameras on this recording (--free-cameras) or calibrate them on it (without "
     "--cameras); if they were estimated with a shape of the board, give that too "
     "(--target-shape)"},
};

const FaultWords& wordsOf(UnmodelledFault fault) {
  return *findBy(kFaultWords, &FaultWords::fault, fault);
}

constexpr double kKnown = 3;  // standard deviations

/// Of component k: a pose's last three are rotations.
const char* unitOf(const FaultWords& words, Eigen::Index k) {
  return words.names.data() == kPose && k >= 3 ? "mrad" : words.unit;
}

/// A component of an estimate, in the unit that is shown.
struct ShownComponent {
  std::string name;  ///< empty: there is one
  double estimate = 0, std = 0;
  const char* unit;
};

/// All components; of cameras those in pixels, as the others have units of their own.
std::vector<ShownComponent> shownOf(const FaultTest& test, const FaultWords& words,
                                    const std::vector<CameraCalibration>& cameras) {
  std::vector<ShownComponent> shown;
  const auto add = [&](const std::string& name, Eigen::Index k) {
    shown.push_back(
        {name, words.scale * test.estimate(k), words.scale * test.std(k), unitOf(words, k)});
  };
  if (test.fault == UnmodelledFault::kGivenCameras) {
    Eigen::Index at = 0;
    for (const CameraCalibration& camera : cameras) {
      const Eigen::Index fu = at + camera.intrinsics.projection.size() - 4;
      Eigen::Index k = fu;
      for (const char* name : {".fu", ".fv", ".pu", ".pv"}) add(camera.name + name, k++);
      at += camera.intrinsics.stacked().size();
    }
    return shown;
  }
  for (Eigen::Index k = 0; k < test.estimate.size(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    add(i < words.names.size() ? words.names[i] : "", k);
  }
  return shown;
}

/// "x +2.00, z +0.13 % (+- 0.01, 0.02)", "tx +2 mm, rz -1.5 mrad (+- 0.1, 0.2)": the components
/// that are known to differ from zero, or else the one that differs most in its deviations. The
/// others would bury them. A unit stands behind the last of those that share it. Components that
/// the motion does not determine have no deviation, and are named.
std::string figures(const std::vector<ShownComponent>& shown) {
  const auto ratio = [](const ShownComponent& c) { return std::abs(c.estimate) / c.std; };
  double least = 0;
  for (const ShownComponent& c : shown) least = std::max(least, ratio(c));
  least = std::min(kKnown, least);
  std::string values, deviations, unit;
  std::vector<std::string> open;
  for (const ShownComponent& c : shown) {
    if (std::isnan(c.std)) open.push_back(c.name);
    if (!(ratio(c) >= least)) continue;
    const char* comma = values.empty() ? "" : ", ";
    if (!values.empty() && unit != c.unit) values += " " + unit;
    unit = c.unit;
    values += fmt::format("{}{}{}{:+.3g}", comma, c.name, c.name.empty() ? "" : " ", c.estimate);
    deviations += fmt::format("{}{:.1g}", comma, c.std);
  }
  std::string text = values.empty() ? "no component is known by itself"
                                    : fmt::format("{} {} (+- {})", values, unit, deviations);
  if (!open.empty()) text += ", not determined by this motion: " + joined(open);
  return text;
}

/// An estimate beyond the range where the fault acts linearly is no test.
bool isTested(const FaultTest& test) { return test.chi2 != 0; }

/// "; no test, as the estimates lie far outside the linear range: target-size; in part, ...".
std::string notTested(const std::vector<FaultTest>& tests) {
  std::vector<std::string> none, part;
  for (const FaultTest& test : tests) {
    if (!isTested(test)) {
      none.emplace_back(toString(test.fault));
    } else if (test.std.hasNaN()) {
      part.emplace_back(toString(test.fault));
    }
  }
  std::string text;
  if (!none.empty()) {
    text += "; no test, as the estimate lies far outside the linear range: " + joined(none);
  }
  if (!part.empty()) {
    text += "; in part, as the motion does not determine every component: " + joined(part);
  }
  return text;
}

/// What is at fault, where, since when or at which frequency, and by how much.
std::string sentence(const FaultTest& test, const CameraImuStageResult& stage) {
  const FaultWords& words = wordsOf(test.fault);
  std::string text = words.what;
  if (test.camera >= 0) {
    text += " of " + stage.cameras[static_cast<std::size_t>(test.camera)].name;
  } else if (test.fault == UnmodelledFault::kLineDelay && stage.cameras.size() > 1) {
    text += ", one estimate for all cameras";
  }
  if (test.since) {
    text += fmt::format(" from {:.1f} s on", secondsBetween(stage.frames.front().t, *test.since));
  }
  if (test.frequency_hz) text += fmt::format(" at {:.2f} Hz", *test.frequency_hz);
  const std::vector<ShownComponent> shown = shownOf(test, words, stage.cameras);
  const bool in_pixels = std::any_of(shown.begin(), shown.end(), [](const ShownComponent& c) {
    return std::abs(c.estimate) >= kKnown * c.std;
  });
  // What is wrong may be distortion or extrinsics alone.
  if (test.fault == UnmodelledFault::kGivenCameras && !in_pixels) return text;
  return fmt::format("{}: {}", text, figures(shown));
}

/// The first cause, with the one that explains the residuals as well. (The further causes were
/// tested with the first in the model.)
std::string firstCause(const FaultDiagnosis& diagnosis, const CameraImuStageResult& stage) {
  const std::string text = sentence(diagnosis.causes.front(), stage);
  if (!diagnosis.alternative) return text;
  return text + " (alternatively " + sentence(*diagnosis.alternative, stage) +
         "; this recording does not distinguish the two)";
}

/// Whether the accelerometer's three scales are one, within what gravity differs by on Earth (9.764
/// to 9.834 m/s^2): then another gravity than was assumed looks the same.
bool mayBeGravity(const FaultTest& test) {
  constexpr double kOnEarth = 0.005;
  if (test.fault != UnmodelledFault::kAccelScale || test.std.hasNaN()) return false;
  const double mean = test.estimate.mean();
  const Eigen::ArrayXd apart = (test.estimate.array() - mean).abs();
  return std::abs(mean) < kOnEarth && (apart <= kKnown * test.std.array()).all();
}

/// What mends it.
std::string cureOf(const FaultTest& test) {
  const std::string cure = wordsOf(test.fault).cure;
  if (!mayBeGravity(test)) return cure;
  return "look up gravity at the place of the recording and state it (--gravity): the three axes "
         "err alike, as they would under another gravity than was assumed; only if it is right, " +
         cure;
}

/// The same of two that are not told apart each one's, as the other's would do harm.
std::string firstCure(const FaultDiagnosis& diagnosis) {
  const std::string cure = cureOf(diagnosis.causes.front());
  if (!diagnosis.alternative) return cure;
  const std::string other = cureOf(*diagnosis.alternative);
  if (other == cure) return cure;
  return fmt::format("find out which of the two it is. If the former: {}. If the latter: {}", cure,
                     other);
}

/// "(1) a; (2) b", of one the text alone.
std::string numbered(const std::vector<std::string>& texts) {
  if (texts.size() == 1) return texts.front();
  int n = 0;
  return joined(
      texts, [&](const std::string& text) { return fmt::format("({}) {}", ++n, text); }, "; ");
}

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
      Fault::kClockDrift,
      Fault::kCameraDelay,
      Fault::kImuMoved,
      Fault::kClockStep,
      Fault::kCameraMoved,
      Fault::kTargetShape,
      Fault::kTargetMoved,
      Fault::kTargetSways,
      Fault::kGyroBiasJump,
      Fault::kAccelBiasJump,
      Fault::kStampsWander,
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

Failure notConverged(const CameraImuStageResult& stage) {
  Failure failure{FailureCode::kCameraImuNotConverged, {{"iterations", stage.summary.iterations}}};
  if (!stage.faults || stage.faults->causes.empty()) return failure;
  // Tested where the solver stopped, which is no optimum: a hint, and no finding with a level.
  const FaultDiagnosis& diagnosis = *stage.faults;
  std::vector<std::string> faults{firstCause(diagnosis, stage)}, cures{firstCure(diagnosis)};
  for (auto cause = diagnosis.causes.begin() + 1; cause != diagnosis.causes.end(); ++cause) {
    faults.push_back(sentence(*cause, stage));
    cures.push_back(cureOf(*cause));
  }
  const std::string found = faults.size() == 1
                                ? "one fault explains the residuals best: "
                                : fmt::format(
                                      "{} faults explain the residuals, found one after the other, "
                                      "each beside those before it: ",
                                      faults.size());
  const bool one_cure = std::ranges::count(cures, cures.front()) == std::ssize(cures);
  failure.values.insert(
      {{"fault", found + numbered(faults)}, {"cure", one_cure ? cures.front() : numbered(cures)}});
  return failure;
}

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
                                         sentence(cause, stage), cureOf(cause), t));
  }
  return findings;
}

}  // namespace plumbline
