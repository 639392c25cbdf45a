// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/results.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/batch/camera_imu/solver.h"

namespace plumbline {

/// Residual of every corner of the problem's frames (rejected ones too, used == false).
std::vector<CornerResidual> cornerResiduals(const CameraImuProblem& problem,
                                            const CameraImuEstimate& estimate);

/// Residual of every inertial link, raw and normalised.
std::vector<ImuIntervalResidual> imuIntervalResiduals(const CameraImuProblem& problem,
                                                      const CameraImuEstimate& estimate,
                                                      const ImuWeights& weights);

/// RMS values and chi-square of the inertial residuals.
ImuResidualSummary summarise(const std::vector<ImuIntervalResidual>& residuals);

/// Covariance of T_SC0, time_offset, if freed the cameras, and "time_offset.cam<i>" of cameras that
/// are not synchronised (camera 0's plus the difference), all else marginalised: the inverse
/// information, plus (sandwich) what the noise of single IMU samples at the frames adds to the
/// gradient by the time offset; it matters for noisy IMUs at high rates. Fails with
/// kNotObservable, naming directions, where a standard deviation exceeds the options' limits.
Result<ParameterCovariance> cameraImuCovariance(const CameraImuProblem& problem,
                                                const CameraImuSolution& solution,
                                                const CameraImuOptions& options);

/// The same parameters at a solution that held them (hold_calibration): the inverse information
/// with states and gravity's direction marginalised, cameras and the differences between the
/// cameras' own offsets held, so that the list is the same for every calibration; with the
/// sandwich's part. The corners are weighted by a Cauchy loss of scale `cauchy_px`; 0: all alike.
/// Empty where the information is singular.
std::optional<ParameterCovariance> heldCovariance(CameraImuProblem problem,
                                                  const CameraImuSolution& solution,
                                                  double cauchy_px);

/// Covariance of every state and of gravity's direction, by the same rules: the selected inverse of
/// the information, plus the sandwich's part. Empty where the information is singular.
std::optional<ImuStateCovariances> stateCovariances(const CameraImuProblem& problem,
                                                    const CameraImuSolution& solution);

/// 0.5 log((2 pi e)^n |Sigma|) [nats] of a positive definite covariance.
double gaussianEntropy(const Eigen::MatrixXd& covariance);

}  // namespace plumbline
