// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/batch/two_stages.h"

namespace plumbline {

std::optional<Eigen::Matrix<double, 7, 7>> covarianceOfCameras(const CameraImuStageResult& stage,
                                                               const Eigen::MatrixXd& C) {
  constexpr Eigen::Index kBoard = kTargetTerms - 1;  // tag_edge moves no pose
  if (!stage.faults || stage.faults->by_cameras.size() == 0) return std::nullopt;
  const Eigen::MatrixXd& J = stage.faults->by_cameras;
  const Eigen::Index cameras = J.cols() - kBoard;
  Eigen::Index n = 0;
  if (C.rows() == cameras) n = cameras;
  if (C.rows() == cameras + kTargetTerms) n = J.cols();
  if (n == 0) return std::nullopt;
  return J.leftCols(n) * C.topLeftCorner(n, n) * J.leftCols(n).transpose();
}

std::optional<Eigen::VectorXd> robustStdOfBothStages(const CameraStageResult& camera,
                                                     const CameraImuStageResult& camera_imu) {
  const auto added = covarianceOfCameras(camera_imu, camera.robust_covariance);
  if (!added) return std::nullopt;
  const Eigen::Matrix<double, 7, 1> own = camera_imu.faults->robust_std.cwiseAbs2();
  return Eigen::VectorXd((own + added->diagonal()).cwiseSqrt());
}

}  // namespace plumbline
