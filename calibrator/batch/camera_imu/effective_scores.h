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

  BorderLayout border;          ///< the calibration's own columns
  int samples = 0;              ///< first of SampleFaults
  int drift = 0;                ///< of the IMU's clock: t_d grows by this a second
  int line_delay = 0;           ///< readout time of the image's height [s]
  int target_size = 0;          ///< relative; the target is larger than stated
  std::vector<int> own_offset;  ///< per camera, less camera 0's [s]; -1 for camera 0
  std::vector<int> T_C0Ci;      ///< per camera, 6; -1 for camera 0
  int size = 0;
};

/// Score and information of a piece of the recording about the border's and the faults' columns,
/// with all states adapting: with J the whitened Jacobian, r the residual, W = dx/dB the response
/// of the states, J~ = J_B + J_x W:   gradient = sum J~' r,   information = sum J~' J~.
struct ScoreBlock {
  TimeNs begin = 0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd information;
};

/// In blocks of about `block_s` seconds. Empty where the system has no inverse or samples do not
/// cover a window.
std::optional<std::vector<ScoreBlock>> effectiveScores(const CameraImuProblem& problem,
                                                       const CameraImuSolution& solution,
                                                       const FaultColumns& columns, double block_s);

}  // namespace plumbline
