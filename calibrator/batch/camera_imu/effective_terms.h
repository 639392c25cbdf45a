// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to the score tests: whitened rows of views and links by the columns of the batch and of
// every fault.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/batch/camera_imu/problem.h"
#include "calibrator/residuals/sample_faults.h"

namespace plumbline {

/// Columns of faults that the batch does not estimate, behind those of its border.
struct FaultColumns {
  FaultColumns(const CameraImuEstimate& estimate, bool free_cameras);

  static constexpr int kShape = kTargetTerms - 1;  // the tags' edges are the detector's

  BorderLayout border;          ///< the calibration's own columns
  int samples = 0;              ///< first of SampleFaults
  int drift = 0;                ///< of the IMU's clock: t_d grows by this a second
  int sway = 0;                 ///< target displaced by a sine, a cosine along x, y, z of F [m]
  int gyro_jump = 0;            ///< of the gyroscope's bias in one link, 3 [rad/s]
  int accel_jump = 0;           ///< of the accelerometer's bias in one link, 3 [m/s^2]
  int target_jump = 0;          ///< of the target in one link, along x, y, z of F [m]
  int of_links = 0;             ///< links touch no column from here on
  int line_delay = 0;           ///< readout time of the image's height [s]
  int target_size = 0;          ///< relative; the target is larger than stated
  int shape = 0;                ///< kShape, of TargetBasis [m]
  std::vector<int> own_offset;  ///< per camera, less camera 0's [s]; -1 for camera 0
  std::vector<int> T_C0Ci;      ///< per camera, 6; -1 for camera 0
  std::vector<int> intrinsics;  ///< per camera, first of stacked()
  int size = 0;
};

/// Whitened rows of the link from frame `at` to the next.
struct LinkTerms {
  std::size_t at = 0;
  Eigen::Matrix<double, Eigen::Dynamic, kChainBlock> J_i, J_j;  // 9 (if inertial) + 6 rows
  Eigen::MatrixXd J_B;  ///< by the first FaultColumns::of_links columns
  Eigen::VectorXd r;
};

/// One view in columns of its own: the twist of the target's pose in the camera (6), which states
/// and border move, and its intrinsics, the target's shape and the line delay, each of which is a
/// column of the border. J' J of these, and J' r.
struct FaultViewTerms {
  std::size_t frame = 0;
  Eigen::Matrix<double, 6, Eigen::Dynamic> H;  ///< the twist's rows, all columns
  Eigen::VectorXd H_own;                       ///< the other rows' upper triangle, row by row
  Eigen::VectorXd b;
  Eigen::Matrix<double, 6, kChainBlock> A_x;
  Eigen::Matrix<double, 6, Eigen::Dynamic> A_B;  ///< by the columns `by` of the border
  std::vector<Eigen::Index> by;                  ///< those that move the pose
  std::vector<Eigen::Index> own;                 ///< those that the columns from 6 on are
};

/// Of all views at a solution.
std::vector<FaultViewTerms> viewTerms(const CameraImuProblem& problem,
                                      const CameraImuSolution& solution,
                                      const FaultColumns& columns);

/// Of every link that is not broken, a target that sways at `sway_hz` among the faults; empty where
/// samples do not cover one. The columns of jumps are zero (placeJumps()).
std::optional<std::vector<LinkTerms>> linkTerms(const CameraImuProblem& problem,
                                                const CameraImuSolution& solution,
                                                const FaultColumns& columns, double sway_hz);

}  // namespace plumbline
