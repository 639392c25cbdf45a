// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/batch/camera_imu/problem.h"
#include "calibrator/linear/block_arrow.h"
#include "calibrator/residuals/imu_residual.h"

namespace plumbline {

// Internal to the score tests: whitened rows of views and links by the columns of the batch and of
// every fault.

/// Columns of faults that the batch does not estimate, behind those of its border.
struct FaultColumns {
  FaultColumns(const CameraImuEstimate& estimate, bool free_cameras);

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
  int shape = 0;                ///< kBoardTerms, of TargetBasis [m]
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

/// Instants of the links where a jump explains most, camera clock.
struct JumpPlaces {
  TimeNs gyro_at = 0, accel_at = 0, target_at = 0;
  /// What a displacement of the target explains in one link of twenty, over what it would by
  /// chance: large where every link has residuals of its own.
  double target_dispersion = 1;
};

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
  JumpPlaces jumps;
};

/// In blocks of about `block_s` seconds. Empty where the system has no inverse or samples do not
/// cover a window.
std::optional<EffectiveScores> effectiveScores(const CameraImuProblem& problem,
                                               const CameraImuSolution& solution,
                                               const FaultColumns& columns, double block_s);

}  // namespace plumbline
