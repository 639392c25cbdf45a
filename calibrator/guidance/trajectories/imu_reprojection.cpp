// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/guidance/trajectories/imu_reprojection.h"

#include <Eigen/Cholesky>
#include <cassert>
#include <cmath>

#include "calibrator/camera/camera.h"
#include "calibrator/information/projection_uncertainty.h"
#include "calibrator/residuals/view_gram.h"

namespace plumbline {
namespace {

/// Mean of J^T J over the grid and the distances.
Matrix6d meanTwistGram(const Intrinsics& camera, const ImuUse& use) {
  Matrix6d sum = Matrix6d::Zero();
  int count = 0;
  for (const Eigen::Vector2d& uv : pixelGrid(camera.resolution, use.columns, use.rows)) {
    const auto ray = unproject(camera, uv);
    if (!ray) continue;
    for (const double range_m : use.ranges_m) {
      const auto J = pixelJacobian(camera, *ray, range_m);
      if (!J) continue;
      // Of the twist alone: the cameras' intrinsics are held in this stage.
      const Eigen::Matrix<double, 2, 6> J_twist = J->leftCols<6>();
      sum += J_twist.transpose() * J_twist;
      ++count;
    }
  }
  return count > 0 ? Matrix6d(sum / count) : sum;
}

}  // namespace

ImuReprojection::ImuReprojection(const std::vector<CameraCalibration>& cameras, const ImuUse& use)
    : use_(use) {
  assert(!cameras.empty());
  for (const CameraCalibration& camera : cameras) {
    cameras_.push_back({camera.T_C0Ci, meanTwistGram(camera.intrinsics, use)});
  }
}

Matrix7d ImuReprojection::gram(const Transform& T_SC0) const {
  Vector6d motion;  // mean squares along each axis
  // Every direction alike: a third of the square falls to each axis, and no two axes go together.
  motion << Eigen::Vector3d::Constant(use_.speed_m_s * use_.speed_m_s / 3),
      Eigen::Vector3d::Constant(use_.rate_rad_s * use_.rate_rad_s / 3);
  Matrix7d M = Matrix7d::Zero();
  for (const Camera& camera : cameras_) {
    const Matrix6d A = cameraImuChain(Transform(), T_SC0, camera.T_C0Ci).A_SC0;
    const Matrix6d B = adjoint((T_SC0 * camera.T_C0Ci).inverse());
    M.topLeftCorner<6, 6>() += A.transpose() * camera.H * A;
    // The mean of (v, omega)^T B^T H B (v, omega) over motions. Beside it row 6 is zero, for there
    // a motion and its opposite cancel.
    M(6, 6) += motion.dot((B.transpose() * camera.H * B).diagonal());
  }
  return M / static_cast<double>(cameras_.size());
}

std::optional<double> ImuReprojection::expectedError(const Eigen::MatrixXd& information,
                                                     const Transform& T_SC0) const {
  assert(information.rows() == 7 && information.cols() == 7);
  const Eigen::LLT<Matrix7d> llt{Matrix7d(information)};
  if (llt.info() != Eigen::Success) return std::nullopt;
  // tr(M H^-1) = tr(H^-1 M): solved for M, without an inverse.
  const double E = llt.solve(gram(T_SC0)).trace();
  return std::isfinite(E) ? std::optional(E) : std::nullopt;
}

double ImuReprojection::expectedErrorUnder(const Eigen::MatrixXd& covariance,
                                           const Transform& T_SC0) const {
  assert(covariance.rows() == 7 && covariance.cols() == 7);
  // tr(M S), both symmetric.
  return gram(T_SC0).cwiseProduct(covariance).sum();
}

double ImuReprojection::differencePx(const ImuCalibration& a, const ImuCalibration& b) const {
  Eigen::Matrix<double, 7, 1> d;
  d << boxminus(a.T_SC0, b.T_SC0), a.timeOffset() - b.timeOffset();
  return std::sqrt(d.dot(gram(b.T_SC0) * d));
}

}  // namespace plumbline
