// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibrator/batch/camera_imu/problem.h"

namespace plumbline {

enum class SolverEnd {
  kConverged,
  kOutOfIterations,
  kSingular,     ///< no damping made the normal equations positive definite
  kLeftSamples,  ///< the time offset moved frames off the IMU samples
};

struct SolverOptions {
  int max_iterations = 50;
  double tolerance = 1e-4;  ///< length of the last step in standard deviations of all parameters
};

struct CameraImuSolution {
  CameraImuEstimate estimate;
  ImuWeights weights;
  CameraImuNormals normals;  ///< at the estimate
  SolverEnd end = SolverEnd::kOutOfIterations;
  int iterations = 0;
};

/// Levenberg-Marquardt on the structured normal equations. The inertial weights are renewed after
/// the second step and whenever the time offset has moved by more than 0.2 ms since; a step with
/// new weights never counts as the last one, and it is judged by the old ones where the new raise
/// the cost.
CameraImuSolution solveCameraImu(const CameraImuProblem& problem, const CameraImuEstimate& start,
                                 const SolverOptions& options = {});

/// The same with the inertial weights held as they are.
CameraImuSolution solveCameraImu(const CameraImuProblem& problem, const CameraImuEstimate& start,
                                 const ImuWeights& weights, const SolverOptions& options = {});

}  // namespace plumbline
