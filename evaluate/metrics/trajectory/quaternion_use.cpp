// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics/trajectory/quaternion_use.h"

#include <cmath>

#include "calibrator/base/transform.h"

namespace plumbline {

Eigen::Matrix3d rotationOf(const Eigen::Quaterniond& q, QuaternionUse use) {
  const Eigen::Quaterniond r = use == QuaternionUse::kNormalised ? q.normalized() : q;
  return (2 * r.w() * r.w() - 1) * Eigen::Matrix3d::Identity() + 2 * r.w() * skew(r.vec()) +
         2 * r.vec() * r.vec().transpose();
}

Eigen::Quaterniond shepperdQuaternion(const Eigen::Matrix3d& R) {
  // 4 (w^2, x^2, y^2, z^2) of a unit quaternion.
  const double trace = R.trace();
  const Eigen::Vector4d squares(1 + trace, 1 + 2 * R(0, 0) - trace, 1 + 2 * R(1, 1) - trace,
                                1 + 2 * R(2, 2) - trace);
  Eigen::Index largest = 0;
  squares.maxCoeff(&largest);
  const double c = 2 * std::sqrt(squares[largest]);  // four times the component
  const Eigen::Vector3d vee(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  Eigen::Vector4d q;  // w, x, y, z
  if (largest == 0) {
    q << c / 4, vee / c;
  } else {
    const Eigen::Index i = largest - 1;
    q << vee[i] / c, (R.col(i) + R.row(i).transpose()) / c;
    q[largest] = c / 4;
  }
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
}

Eigen::Vector3d rotationVector(const Eigen::Matrix3d& R) {
  const double trace = R.trace();
  // Within 0.01 rad of a half turn (1 + tr R = 4 cos^2(theta / 2) = theta'^2, theta' = pi - theta)
  // R - R^T vanishes and with it the axis.
  if (trace + 1 < 1e-4) {
    const Eigen::AngleAxisd turn(shepperdQuaternion(R));
    return turn.angle() * turn.axis();
  }
  const Eigen::Vector3d vee(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  // theta^2 = 3 - tr R to second order, and theta / (2 sin theta) = 1/2 + theta^2 / 12.
  if (trace - 3 >= -1e-7) return (0.5 - (trace - 3) / 12) * vee;
  const double theta = std::acos((trace - 1) / 2);
  return theta / (2 * std::sin(theta)) * vee;
}

}  // namespace plumbline
