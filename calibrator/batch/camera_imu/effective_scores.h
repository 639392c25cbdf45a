// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrator/batch/camera_imu/problem.h"
#include "calibrator/residuals/sample_faults.h"

namespace plumbline {

/// Columns of faults that the batch does not estimate, behind those of its border.
struct FaultColumns {
  FaultColumns(const CameraImuEstimate& estimate, bool free_cameras);

  static constexpr int kShape = 11;

  BorderLayout border;          ///< the calibration's own columns
  int samples = 0;              ///< first of SampleFaults
  int drift = 0;                ///< of the IMU's clock: t_d grows by this a second
  int line_delay = 0;           ///< readout time of the image's height [s]
  int target_size = 0;          ///< relative; the target is larger than stated
  int shape = 0;                ///< kShape, see shapeColumns() [m]
  int sway = 0;                 ///< target displaced by a sine, a cosine along x, y, z of F [m]
  int gyro_jump = 0;            ///< of the gyroscope's bias in one link, 3 [rad/s]
  int accel_jump = 0;           ///< of the accelerometer's bias in one link, 3 [m/s^2]
  int target_jump = 0;          ///< of the target in one link, along x, y, z of F [m]
  std::vector<int> own_offset;  ///< per camera, less camera 0's [s]; -1 for camera 0
  std::vector<int> T_C0Ci;      ///< per camera, 6; -1 for camera 0
  std::vector<int> intrinsics;  ///< per camera, first of stacked()
  int size = 0;
};

/// Displacement of a point of the target by eleven terms [m]: with X, Y from the target's centre
/// over half its diagonal, stretch (X, -Y, 0), shear (Y, X, 0), then X^2, X Y, Y^2 along x, along y
/// and along z. What a similarity or a plane does is left out: poses and size do that.
Eigen::Matrix<double, 3, FaultColumns::kShape> shapeColumns(const AprilGrid& target, double x,
                                                            double y);

/// Score and information of a piece of the recording about the border's and the faults' columns,
/// with all states adapting: with J the whitened Jacobian, r the residual, W = dx/dB the response
/// of the states, J~ = J_B + J_x W:   gradient = sum J~' r,   information = sum J~' J~.
struct ScoreBlock {
  TimeNs begin = 0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd information;
};

struct EffectiveScores {
  std::vector<ScoreBlock> blocks;
  double sway_hz = 0;  ///< frequency at which the forces left over in F are largest
  /// Instants of the links where a jump explains most, camera clock.
  TimeNs gyro_jump_at = 0, accel_jump_at = 0, target_jump_at = 0;
  /// What a displacement of the target explains in one link of twenty, over what it would by
  /// chance: large where every link has residuals of its own.
  double target_jump_dispersion = 1;
};

/// In blocks of about `block_s` seconds. A jump's link is that with the largest
///   s' A^-1 s,   s = C' r,   A = C' (1 - J S J') C,
/// C what the jump adds to the link's whitened residual r, J its Jacobian and S the covariance of
/// states and border. Empty where the system has no inverse or samples do not cover a window.
std::optional<EffectiveScores> effectiveScores(const CameraImuProblem& problem,
                                               const CameraImuSolution& solution,
                                               const FaultColumns& columns, double block_s);

}  // namespace plumbline
