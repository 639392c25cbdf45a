// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/rules/fault_text.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

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
constexpr const char* kMount[] = {"tx by x", "ty by x", "tz by x", "rx by x", "ry by x", "rz by x",
                                  "tx by y", "ty by y", "tz by y", "rx by y", "ry by y", "rz by y",
                                  "tx by z", "ty by z", "tz by z", "rx by z", "ry by z", "rz by z"};
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
    {UnmodelledFault::kSoftMount,
     "cameras and IMU move against each other with the acceleration (a soft mount)", 1e3,
     "mm per m/s^2",
     "mount cameras and IMU rigidly on one part, without rubber or a long or thin arm between "
     "them, and record again",
     kMount},
    {UnmodelledFault::kColumnDelay,
     "readout time from the image's left to its right (a rolling shutter mounted on its side)", 1e3,
     "ms", "use a global shutter, or record slow motion: rolling shutters are not modelled"},
};

const FaultWords& wordsOf(UnmodelledFault fault) {
  return *findBy(kFaultWords, &FaultWords::fault, fault);
}

constexpr double kKnown = 3;  // standard deviations

/// Of component k: a pose's last three are rotations.
const char* unitOf(const FaultWords& words, Eigen::Index k) {
  if (words.names.data() == kMount) return k % 6 < 3 ? words.unit : "mrad per m/s^2";
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

/// Whether the accelerometer's three scales are one, within what gravity differs by on Earth (9.764
/// to 9.834 m/s^2): then another gravity than was assumed looks the same.
bool mayBeGravity(const FaultTest& test) {
  constexpr double kOnEarth = 0.005;
  if (test.fault != UnmodelledFault::kAccelScale || test.std.hasNaN()) return false;
  const double mean = test.estimate.mean();
  const Eigen::ArrayXd apart = (test.estimate.array() - mean).abs();
  return std::abs(mean) < kOnEarth && (apart <= kKnown * test.std.array()).all();
}

/// "(1) a; (2) b", of one the text alone.
std::string numbered(const std::vector<std::string>& texts) {
  if (texts.size() == 1) return texts.front();
  int n = 0;
  return joined(
      texts, [&](const std::string& text) { return fmt::format("({}) {}", ++n, text); }, "; ");
}

}  // namespace

bool isTested(const FaultTest& test) { return test.chi2 != 0; }

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

std::string faultText(const FaultTest& test, const CameraImuStageResult& stage) {
  const FaultWords& words = wordsOf(test.fault);
  std::string text = words.what;
  if (test.camera >= 0) {
    text += " of " + stage.cameras[static_cast<std::size_t>(test.camera)].name;
  } else if ((test.fault == UnmodelledFault::kLineDelay ||
              test.fault == UnmodelledFault::kColumnDelay) &&
             stage.cameras.size() > 1) {
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

std::string firstCause(const FaultDiagnosis& diagnosis, const CameraImuStageResult& stage) {
  const std::string text = faultText(diagnosis.causes.front(), stage);
  if (!diagnosis.alternative) return text;
  return text + " (alternatively " + faultText(*diagnosis.alternative, stage) +
         "; this recording does not distinguish the two)";
}

std::string cureOf(const FaultTest& test) {
  const std::string cure = wordsOf(test.fault).cure;
  if (!mayBeGravity(test)) return cure;
  return "look up gravity at the place of the recording and state it (--gravity): the three axes "
         "err alike, as they would under another gravity than was assumed; only if it is right, " +
         cure;
}

std::string firstCure(const FaultDiagnosis& diagnosis) {
  const std::string cure = cureOf(diagnosis.causes.front());
  if (!diagnosis.alternative) return cure;
  const std::string other = cureOf(*diagnosis.alternative);
  if (other == cure) return cure;
  return fmt::format("find out which of the two it is. If the former: {}. If the latter: {}", cure,
                     other);
}

Failure notConverged(const CameraImuStageResult& stage) {
  Failure failure{FailureCode::kCameraImuNotConverged, {{"iterations", stage.summary.iterations}}};
  if (!stage.faults || stage.faults->causes.empty()) return failure;
  // Tested where the solver stopped, which is no optimum: a hint, and no finding with a level.
  const FaultDiagnosis& diagnosis = *stage.faults;
  std::vector<std::string> faults{firstCause(diagnosis, stage)}, cures{firstCure(diagnosis)};
  for (auto cause = diagnosis.causes.begin() + 1; cause != diagnosis.causes.end(); ++cause) {
    faults.push_back(faultText(*cause, stage));
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

}  // namespace plumbline
