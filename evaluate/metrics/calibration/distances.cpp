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

ImuVariances imuVariances(const CameraImuStageResult& estimated) {
  const ImuCalibration& imu = estimated.imu;
  ImuVariances out;
  for (std::size_t k = 0; k < kImuParameters; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const double formal = k < 6 ? (*imu.T_SC0_std)[i] : *imu.time_offset_std_s;
    out[k].value = formal * formal;
    if (!estimated.faults) continue;
    const FaultDiagnosis& faults = *estimated.faults;
    const EstimatedVariance robust{
        faults.robust_std[i] * faults.robust_std[i],
        faults.robust_dof ? (*faults.robust_dof)[i] : EstimatedVariance{}.dof};
    // Without a degree of freedom it says nothing.
    if (std::isfinite(robust.value) && robust.value > 0 && robust.dof > 0) out[k] = robust;
  }
  return out;
}

Eigen::Matrix<double, 7, 7> imuCovariance(const CameraImuStageResult& estimated) {
  Eigen::Matrix<double, 7, 7> S = estimated.summary.covariance.matrix.topLeftCorner<7, 7>();
  const ImuVariances variances = imuVariances(estimated);
  for (Eigen::Index k = 0; k < 7; ++k) {
    const double scale = std::sqrt(variances[static_cast<std::size_t>(k)].value / S(k, k));
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
