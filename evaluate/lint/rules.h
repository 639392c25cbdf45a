// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibrator/base/transform.h"
#include "evaluate/lint/lint.h"
#include "evaluate/metrics/verdict.h"

namespace plumbline::lint {

/// Between cameras, or from IMU to camera: more is another unit.
inline constexpr double kMaxBaseline_m = 5;
inline constexpr double kMaxLeverArm_m = 2;  ///< from IMU to camera, whatever carries them
/// From IMU to camera within one device (their topics say so), unless this many of its longest
/// baselines are longer.
inline constexpr double kDeviceLeverArm_m = 0.1;
inline constexpr double kDeviceBaselines = 2;
inline constexpr double kMaxOffset_s = 0.5;         ///< time offset; more is milliseconds
inline constexpr double kMaxPrincipalShift = 0.15;  ///< off the centre, of the image's size
inline constexpr double kMaxGyroDensity = 0.05;     ///< [rad/s/sqrt(Hz)]
inline constexpr double kMaxAccelDensity = 1;       ///< [m/s^2/sqrt(Hz)]
inline constexpr double kSameRotation_rad = 0.05;   ///< up to which rotations count as equal
inline constexpr double kSameTranslation_m = 0.02;  ///< likewise of translations
inline constexpr double kFlipOffset_s = 5e-4;   ///< offsets below this have no sign worth comparing
inline constexpr double kOddLeverArm_m = 0.05;  ///< off the other calibrations' median
inline constexpr double kOddFactor = 3;         ///< and this many times their median distance
inline constexpr double kRatioTolerance = 0.03;  ///< of ratios that unit mistakes leave, relative
inline constexpr double kOffsetTolerance_s = 2e-3;     ///< of an offset against the correlation
inline constexpr double kRotationTolerance_rad = 0.1;  ///< of T_SC0 against the session's rates
/// RMS of the corners above which poses by a calibration's camera are none to compare the IMU with:
/// more than a fifth of false corners makes.
inline constexpr double kPosesFit_px = 5;
/// Of a stated density over what the samples' noise can be at most.
inline constexpr double kNoiseFactor = 5;

/// A finding's numbers: what was compared with which bound, and in which unit.
struct Measured {
  double value = 0;
  double threshold = 0;
  const char* unit = "";
};

inline Finding bad(const std::string& rule, const std::string& evidence, const std::string& advice,
                   const Measured& measured) {
  return {rule,           VerdictLevel::kBad, evidence,     advice,
          measured.value, measured.threshold, measured.unit};
}

/// What one file says of itself.
std::vector<Finding> alone(const LintedCalibration& linted);

/// How far two transforms are apart.
struct Distance {
  double rotation_rad = 0;
  double translation_m = 0;
};
Distance distanceBetween(const Transform& a, const Transform& b);

/// Of each component its median; of one point at least.
Eigen::Vector3d componentMedian(const std::vector<Eigen::Vector3d>& points);

/// Whether `given` is the inverse of `reference` rather than `reference` itself.
bool isInverse(const Transform& given, const Transform& reference);

}  // namespace plumbline::lint
