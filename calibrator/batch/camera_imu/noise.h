// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibrator/base/results.h"
#include "calibrator/batch/camera_imu/problem.h"
#include "calibrator/batch/camera_imu/solver.h"

namespace plumbline {

struct ImuNoiseOptions {
  /// A group keeps its assumed density while its redundancy is below this.
  double least_redundancy = 10;
  int max_rounds = 8;
  double tolerance = 0.02;  ///< end where no factor is asked to change by more, relative
  /// Longer recordings are judged on stretches of 100 frames spread evenly over them, this many
  /// frames in all: more would cost as much as the calibration and say little more.
  int max_frames = 300;
};

/// What the inertial residuals say of the assumed densities.
///
/// Whitened residuals at an optimum are r = (I - P) n with P = J S J', S the joint covariance of
/// all unknowns; their expected square is 1 - P_kk, far from 1 where an interval's own states
/// absorb its residual. The sum of 1 - P_kk over a group of rows is its redundancy. The groups:
/// rotation rows (gyroscope), velocity and position rows (accelerometer), the walk of either bias;
/// and the poses, six rows a frame: the distance to the pose that the frame's corners alone would
/// choose, in the metric of their information.
///
/// Each group's variance is multiplied by |r|^2 / redundancy until nothing changes, every time with
/// the residuals of the optimum under these variances (one linear step): iterated almost unbiased
/// estimation of variance components (Foerstner 1979), which ends in restricted maximum likelihood.
/// The poses' scale takes pixel_sigma out of the statement, and takes up errors that the corners of
/// a view share (blur, a wrong model), which reprojection residuals hide: noise of poses is fresh
/// in every frame, noise of rates adds up, and that tells them apart. In simulation pixel_sigma of
/// 1 where 0.2 is right changes factors by 1 to 3 %.
///
/// To be trusted where the redundancy is large: a factor's relative deviation is 1 / sqrt(2
/// redundancy) or somewhat more. Vibration, scale and alignment errors of the IMU and distortion of
/// the integration count as noise of the IMU. Redundancies are 0 where the system has no inverse.
/// Takes over problem and solution, which are large: move them in where they are needed no more.
ImuNoiseChecks checkImuNoise(CameraImuProblem problem, CameraImuSolution solution,
                             const ImuNoiseOptions& options = {});

}  // namespace plumbline
