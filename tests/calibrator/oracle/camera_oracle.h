// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The oracle of the camera batch: link plumbline_oracle and include
// "tests/calibrator/oracle/camera_oracle.h". It solves the whole problem with Ceres, corner by
// corner with automatic differentiation, and shares with the structured solver nothing but the
// projection functions.

#include <Eigen/Core>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/frames.h"
#include "calibrator/base/session.h"

namespace plumbline::oracle {

struct CameraOptions {
  double cauchy_px = 0;    ///< scale of the Cauchy loss as in GramOptions [px]; 0: none
  double pixel_sigma = 1;  ///< [px]; cost = 0.5 sum rho(|e|^2) / sigma^2
  int max_iterations = 300;
  int threads = 1;
  bool covariance = true;  ///< whether to compute it
};

struct CameraState {
  std::vector<CameraCalibration> cameras;  ///< intrinsics and T_C0Ci; camera 0 is the reference
  std::vector<Transform> T_FC0;            ///< one per frame
};

struct CameraSolution {
  CameraState state;
  double cost = 0;  ///< 0.5 sum rho(|e|^2) / sigma^2
  bool converged = false;
  int iterations = 0;
  /// Of (intrinsics of camera 0, 1, ..., then the tangents of T_C0C1, T_C0C2, ...), poses
  /// marginalised: (J^T W J)^-1 with W the loss' weights. Empty if it was not asked for.
  Eigen::MatrixXd covariance;
};

/// Minimises the reprojection error of all corners of the frames' views from `start`, to rounding.
CameraSolution solveCameras(const Session& session, const std::vector<Frame>& frames,
                            const CameraState& start, const CameraOptions& options = {});

/// Parameters of `to` minus `from` in the order of the covariance (tangent of Transform).
Eigen::VectorXd difference(const CameraState& to, const CameraState& from);

}  // namespace plumbline::oracle
