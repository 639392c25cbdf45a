// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/results.h"
#include "calibrator/base/statistics/statistics.h"

namespace plumbline {

/// A distance from an estimate, and the standard deviation of that estimate; in one unit.
struct Distance {
  double value = 0, std = 0;

  /// RMS error to be expected against the truth of what lies so far from the estimate, where it
  /// was estimated from a part of the same data, under what both take as given: an efficient
  /// estimate's own error is not correlated with the distance of a less efficient one from it
  /// (Hausman 1978), so that the squares add; approximately, where the model misfits.
  double expectedError() const { return std::hypot(value, std); }
};

/// How far a camera is from an estimated one.
struct CameraDistance {
  std::string name;
  /// RMS over the image, at infinity, a rotation taken out: sqrt(dk^T M dk) with the M of
  /// imageFitMeanSquare() at the estimate, dk the difference of the intrinsics [px].
  Distance projection_px;
  Distance translation_m, rotation_rad;  ///< of T_C0Ci; of camera 0 both are 0
};

/// How far `cameras` are from those of a batch, one per camera, to first order; of the same models.
/// The deviations are the batch's cluster-robust ones, formal ones where there are none.
std::vector<CameraDistance> cameraDistances(const std::vector<CameraCalibration>& cameras,
                                            const CameraStageResult& estimated);

/// T_SC0 (3 m, 3 rad) and the time offset [s].
inline constexpr std::size_t kImuParameters = 7;
using ImuVariances = std::array<EstimatedVariance, kImuParameters>;

/// Variances of a batch's T_SC0 and time offset under the cameras that it held: cluster-robust
/// where they are known with a degree of freedom, as `calibrate` states them, otherwise formal. By
/// formal ones alone, what the recording's own unmodelled errors do would be called a
/// contradiction.
ImuVariances imuVariances(const CameraImuStageResult& estimated);

/// The formal covariance, its deviations scaled to those.
Eigen::Matrix<double, 7, 7> imuCovariance(const CameraImuStageResult& estimated);

/// How far T_SC0 and the time offset are from those of a batch.
struct ImuDistance {
  Distance translation_m, rotation_rad, offset_s;
};
ImuDistance imuDistance(const ImuCalibration& imu, const CameraImuStageResult& estimated);

}  // namespace plumbline
