// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/batch.h"

namespace plumbline {

/// Whether the halves of a recording, each solved apart from the whole's solution, agree.
///
/// For each block of parameters, d their difference, F the sum of both halves' formal covariances
/// at the noise that their corners have (noiseRatio()) and R that of their cluster-robust ones
/// (camera/information.h) from M blocks of time:
///   chi2 = d^T C^-1 d,   L^-1 C L^-T = (1 - a) W + a max(1, tr W / p) 1,   W = L^-1 R L^-T,
/// F = L L^T, p parameters, a = p / (p + M): the robust covariance, drawn towards the formal one at
/// the size of the robust one, since M blocks do not fill p x p entries (a linear shrinkage after
/// Ledoit and Wolf, "A well-conditioned estimator for large-dimensional covariance matrices",
/// 2004). The limit is the 99 % quantile of chi-square with p degrees, times (M - 2) / (M - p - 3)
/// for the deviations being estimates (Hotelling; at most 3).
///
/// Blocks: each camera's intrinsics, each T_C0Ci, and the board's terms where they were estimated.
/// Empty where a half has no solution, or too few blocks of time.
std::optional<HalvesCheck> checkCameraHalves(const Session& session, const CameraStageResult& whole,
                                             const CameraStageOptions& options = {});

/// The same for the camera-IMU stage, the cameras held at the whole's: translation and rotation of
/// T_SC0, time offset. The robust deviations are the halves' formal ones times the ratio that the
/// whole's diagnosis has (FaultDiagnosis), at least 1, or the noise of the whole's corners over
/// pixel_sigma where that is less; F is taken at that noise. Empty also without a diagnosis.
std::optional<HalvesCheck> checkCameraImuHalves(const Session& session,
                                                const CameraImuStageResult& whole,
                                                const CameraImuOptions& options = {});

/// What chi-square with so many degrees of freedom exceeds once in a hundred times.
double chiSquare99(double degrees);

/// A block of parameters to be compared.
struct HalvesDifference {
  std::string name;
  std::vector<ParameterName> parameters;
  Eigen::VectorXd difference;  ///< second half minus first
  Eigen::MatrixXd formal;      ///< covariance of the difference
  Eigen::MatrixXd robust;
  double blocks = 0;  ///< of time, on which `robust` stands
  /// M of M M^T, covariance of the difference by an error that all views share; empty: none.
  Eigen::MatrixXd moves{};
};
HalvesBlock compareHalves(const HalvesDifference& block);

/// Share of each camera's mean squared reprojection error that is systematic (Hagemann, Knorr,
/// Janssen, Stiller: Inferring bias and uncertainty in camera calibration, IJCV 2022):
///   ratio = 1 - noise^2 / error^2, at least 0.
/// noise is the detector's: what residuals leave of an affine function of the corner's place on the
/// board, fitted to each patch of 2 x 2 tags seen whole in a view, per axis, over all degrees of
/// freedom (2 (16 - 3) a patch). Lens, pose and shape of the board err smoothly over a patch; noise
/// does not, nor do tags whose edges look wider, which count as noise. error is that of all used
/// corners per axis, six degrees of freedom less for each frame's pose. A ratio near 0 says that
/// lens model and board leave nothing that noise does not explain; by chance it is below
/// 2 / sqrt(patches).
///
/// Patches do not overlap: tags (2i, 2j) to (2i + 1, 2j + 1). `stage` has the residuals.
std::vector<BiasRatio> biasRatios(const AprilGrid& board, const CameraStageResult& stage);

}  // namespace plumbline
