// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace plumbline {

/// What is done with quaternions whose length is not exactly one, such as those of a text file.
enum class QuaternionUse {
  kNormalised,  ///< made unit first; every result is of a rotation
  kAsRead,      ///< put into the formula for unit ones as they are, as ov_eval does
};

/// R(q) = (2 w^2 - 1) I + 2 w [v]x + 2 v v^T of the Hamilton quaternion (w, v). With kAsRead and a
/// length of 1 + e this is a rotation only up to terms of order e.
Eigen::Matrix3d rotationOf(const Eigen::Quaterniond& q, QuaternionUse use);

/// The unit quaternion of R by Shepperd's method: the largest of its components from the diagonal,
/// the others divided by it. Where R is not exactly a rotation the choice of the component shows,
/// so ov_eval's figures need this very one.
Eigen::Quaterniond shepperdQuaternion(const Eigen::Matrix3d& R);

/// The rotation vector [rad] as theta / (2 sin theta) (R - R^T)^v with theta = acos((tr R - 1) /
/// 2), and its series near zero: exact to rounding for rotations up to 0.01 rad below pi (beyond,
/// by way of the quaternion), and for matrices that are nearly rotations the value that ov_eval
/// gives.
Eigen::Vector3d rotationVector(const Eigen::Matrix3d& R);

}  // namespace plumbline
