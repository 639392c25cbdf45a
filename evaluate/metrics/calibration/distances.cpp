// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/calibration/distances.h"

#include <limits>

#include "calibrator/base/transform.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/information/projection_uncertainty.h"

namespace plumbline {
namespace {

double rmsOver(const Intrinsics& camera, const Eigen::MatrixXd& second_moment) {
  return std::sqrt(
      imageFitMeanSquare(camera, second_moment).value_or(std::numeric_limits<double>::quiet_NaN()));
}

}  // namespace

std::vector<CameraDistance> cameraDistances(const std::vector<CameraCalibration>& cameras,
                                            const CameraStageResult& estimated) {
  const CameraEstimate own = estimateOf(estimated.cameras);
  const CameraLayout layout(own.intrinsics);
  const Eigen::VectorXd off = cameraDifference(cameras, estimated.cameras);
  const Eigen::MatrixXd& S = estimated.robust_covariance ? estimated.robust_covariance->matrix
                                                         : estimated.summary.covariance.matrix;
  std::vector<CameraDistance> all;
  for (std::size_t c = 0; c < own.intrinsics.size(); ++c) {
    const Intrinsics& camera = own.intrinsics[c];
    const int at = layout.intrinsics[c], size = layout.intrinsics_size[c];
    const Eigen::VectorXd dk = off.segment(at, size);
    CameraDistance& d = all.emplace_back();
    d.name = estimated.cameras[c].name;
    d.projection_px = {rmsOver(camera, dk * dk.transpose()),
                       rmsOver(camera, S.block(at, at, size, size))};
    if (c == 0) continue;
    const Vector6d moved = off.segment<6>(layout.T_C0Ci[c]);
    const Vector6d variance = S.diagonal().segment<6>(layout.T_C0Ci[c]);
    d.translation_m = {moved.head<3>().norm(), std::sqrt(variance.head<3>().sum())};
    d.rotation_rad = {moved.tail<3>().norm(), std::sqrt(variance.tail<3>().sum())};
  }
  return all;
}

Eigen::Matrix<double, 7, 7> imuCovariance(const CameraImuStageResult& estimated) {
  Eigen::Matrix<double, 7, 7> S = estimated.summary.covariance.matrix.topLeftCorner<7, 7>();
  if (!estimated.faults) return S;
  for (Eigen::Index k = 0; k < 7; ++k) {
    const double scale = estimated.faults->robust_std[k] / std::sqrt(S(k, k));
    // Without a degree of freedom it says nothing.
    const auto& dof = estimated.faults->robust_dof;
    if (!std::isfinite(scale) || !(scale > 0) || (dof && !((*dof)[k] > 0))) continue;
    S.row(k) *= scale;
    S.col(k) *= scale;
  }
  return S;
}

ImuDistance imuDistance(const ImuCalibration& imu, const CameraImuStageResult& estimated) {
  const Vector6d off = boxminus(imu.T_SC0, estimated.imu.T_SC0);
  const Eigen::Matrix<double, 7, 1> variance = imuCovariance(estimated).diagonal();
  return {{off.head<3>().norm(), std::sqrt(variance.head<3>().sum())},
          {off.tail<3>().norm(), std::sqrt(variance.segment<3>(3).sum())},
          {std::abs(imu.timeOffset() - estimated.imu.timeOffset()), std::sqrt(variance[6])}};
}

}  // namespace plumbline
