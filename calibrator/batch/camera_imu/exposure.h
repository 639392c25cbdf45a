// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "calibrator/base/transform.h"
#include "calibrator/batch/camera_imu/problem.h"

namespace plumbline {

/// Seconds from frame i's instant to the exposure of camera c's view in it (which must exist): the
/// difference of their stamps plus what the camera's own offset differs from camera 0's. 0 for
/// cameras that are synchronised.
double exposureDelay(const CameraImuProblem& problem, const CameraImuEstimate& estimate,
                     std::size_t i, std::size_t c);

/// The sensor's pose at an exposure some milliseconds d after (or before) a frame's instant:
///   R' = R Exp(w d),   t' = t + v d + a d^2 / 2,
/// with rate w and acceleration a of the IMU half-way between the two. Error O(d^3). Derivatives in
/// the tangent of T_FS, exact for linearly interpolated samples.
struct ExposurePose {
  Transform T_FS;
  Eigen::Matrix<double, 6, 15> by_state;                          ///< of the frame, as boxplus()
  Eigen::Matrix<double, 6, BorderLayout::kFixed> by_calibration;  ///< T_SC0 (zero), gravity, t_d
  Vector6d by_delay;
};
ExposurePose exposurePose(const CameraImuProblem& problem, const CameraImuEstimate& estimate,
                          std::size_t i, double delay_s);

/// Which view: of a frame, by a camera.
struct ViewIndex {
  std::size_t frame = 0;
  std::size_t camera = 0;
};

/// Gauss-Newton terms of a view at its exposure (as in PoseGram), unscaled, in the columns: state
/// of the frame (15), T_SC0, gravity and t_d, delay, T_C0Ci, intrinsics (if cameras are free).
struct MovedView {
  static constexpr int kFixed = 15;
  static constexpr int kDelay = kFixed + BorderLayout::kFixed;
  static constexpr int kT_C0Ci = kDelay + 1;
  static constexpr int kIntrinsics = kT_C0Ci + 6;
  Eigen::MatrixXd H;
  Eigen::VectorXd b;
  double cost = 0;
  double squared_error = 0;
};
MovedView movedView(const CameraImuProblem& problem, const CameraImuEstimate& estimate,
                    const GramOptions& gram, const ViewIndex& index);

/// Camera c's view of the target in frame i, at its exposure.
Transform targetInCamera(const CameraImuProblem& problem, const CameraImuEstimate& estimate,
                         std::size_t i, std::size_t c);

}  // namespace plumbline
