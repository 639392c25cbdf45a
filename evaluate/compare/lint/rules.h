// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/session.h"
#include "calibrator/initialise/imu_alignment.h"
#include "evaluate/compare/lint.h"
#include "evaluate/metrics/verdict.h"

namespace plumbline::lint {

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
std::vector<Finding> alone(const LintedCalibration& linted, const LintOptions& options);

/// What files of one rig say of each other; `suspects` (parallel) are those with a finding already,
/// which are left out.
std::vector<Finding> together(std::span<const LintedCalibration> calibrations,
                              const std::vector<bool>& suspects, const LintOptions& options);

/// How far two transforms are apart.
struct Distance {
  double rotation_rad = 0;
  double translation_m = 0;
};
Distance distanceBetween(const Transform& a, const Transform& b);

/// Whether `given` is the inverse of `reference` rather than `reference` itself.
bool isInverse(const Transform& given, const Transform& reference, const LintOptions& options);

/// Poses T_FC of one camera of a session by its corners alone (camera 0 of each CameraPose is this
/// camera).
std::vector<CameraPose> posesOf(const Session& session, std::size_t camera,
                                const Intrinsics& intrinsics);

/// Pause between neighbouring poses [s] beyond which they give no rate: two and a half intervals.
double longestGap(const std::vector<CameraPose>& poses);

/// Median of T_C0Ck between poses of two cameras at the same time (2 ms); nothing where fewer than
/// 5 frames have both.
std::optional<Transform> medianBaseline(const std::vector<CameraPose>& camera_0,
                                        const std::vector<CameraPose>& camera_k);

/// RMS reprojection error [px] of a camera's corners under those poses, over every few views.
double reprojectionRms(const Session& session, std::size_t camera, const Intrinsics& intrinsics,
                       const std::vector<CameraPose>& poses);

/// An upper bound for the white noise of one sample, from the median second difference (motion
/// adds to it): of the gyroscope [rad/s] or the accelerometer [m/s^2].
double sampleNoise(std::span<const ImuSample> samples, Eigen::Vector3d ImuSample::*column);

}  // namespace plumbline::lint
