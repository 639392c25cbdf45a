// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

#include "calibrator/base/time.h"
#include "calibrator/batch/camera_imu/problem.h"

namespace plumbline {

/// What a window knows at its last frame.
struct WindowKnowledge {
  /// Of (last state (15), T_SC0 (6), gravity (2), time offset (1)), all earlier states
  /// marginalised.
  Eigen::MatrixXd information;
  CameraImuEstimate estimate;  ///< with the last state alone
  TimeNs t = 0;                ///< of the last frame
  /// Variance of the gradient by these by the noise of corners, of pixel_sigma, alone
  /// (QuadraticCost::noise): what corners bring of the information.
  Eigen::MatrixXd corners{};
};

/// Information of T_SC0, and with `offset` of the time offset after it, from that of (.., T_SC0
/// (6), gravity (2), time offset (1)), all else marginalised; without `offset` the offset counts as
/// known. Empty where the rest is not determined.
std::optional<Eigen::MatrixXd> calibrationInformation(const Eigen::MatrixXd& information,
                                                      bool offset);

/// True variances over those that the weights assume.
struct NoiseVariances {
  double corners = 1;
  double imu = 1;  ///< of all inertial rows alike
};

/// Covariance of T_SC0 (6) and the time offset (7 x 7) under other noise than assumed:
/// covarianceUnder() of a window. Empty where they are not determined.
std::optional<Eigen::MatrixXd> calibrationCovariance(const WindowKnowledge& known,
                                                     const NoiseVariances& variances);

}  // namespace plumbline
