// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/transform.h"

namespace plumbline {

Transform Transform::fromMatrix(const Eigen::Matrix4d& T) {
  // Matrices of files are rounded: what is left of orthogonality would grow with every product.
  return {nearestRotation(T.topLeftCorner<3, 3>()), T.topRightCorner<3, 1>()};
}

Eigen::Matrix4d Transform::matrix() const {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = R;
  T.topRightCorner<3, 1>() = t;
  return T;
}

Transform boxplus(const Transform& T, const Vector6d& d) {
  // Over a unit quaternion, so that many small steps do not leave SO(3) by rounding.
  const Eigen::Matrix3d R = expSO3(d.tail<3>()) * T.R;
  return {Eigen::Quaterniond(R), T.t + d.head<3>()};
}

Vector6d boxminus(const Transform& to, const Transform& from) {
  Vector6d d;
  d << to.t - from.t, logSO3(to.R * from.R.transpose());
  return d;
}

double rotationAngle(const Eigen::Matrix3d& R) { return logSO3(R).norm(); }

}  // namespace plumbline
