// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/base/transform.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>

namespace plumbline {
namespace {

// Squared angle below which series replace sin(t)/t and kin: what they leave out there, t^4 / 120,
// is below rounding.
constexpr double kSmallAngle2 = 1e-8;

}  // namespace

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

Eigen::Matrix3d skew(const Eigen::Vector3d& w) {
  Eigen::Matrix3d W;
  W << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return W;
}

// Rodrigues: R = I + sin(t)/t W + (1 - cos t)/t^2 W^2, t = |w|.
Eigen::Matrix3d expSO3(const Eigen::Vector3d& w) {
  const double t2 = w.squaredNorm();
  double a = 1 - t2 / 6;
  double b = 0.5 - t2 / 24;
  if (t2 > kSmallAngle2) {
    const double t = std::sqrt(t2);
    const double s = std::sin(t / 2) / t;
    a = std::sin(t) / t;
    b = 2 * s * s;  // (1 - cos t) / t^2 without cancellation
  }
  const Eigen::Matrix3d W = skew(w);
  return Eigen::Matrix3d::Identity() + a * W + b * W * W;
}

// Through the quaternion: the arc cosine of the trace loses half of the digits near 0 and near pi,
// the arc tangent of |vec| and w loses none. q and -q are the same rotation; w >= 0 gives |w| <=
// pi.
Eigen::Vector3d logSO3(const Eigen::Matrix3d& R) {
  Eigen::Quaterniond q(R);
  if (q.w() < 0) q.coeffs() *= -1;
  const double n = q.vec().norm();
  // atan(x) / x = 1 - x^2 / 3 ...: 1 to the last digit there.
  if (n < 1e-9) return 2 * q.vec() / q.w();
  return q.vec() * (2 * std::atan2(n, q.w()) / n);
}

// I + (1 - cos t)/t^2 W + (t - sin t)/t^3 W^2. The last coefficient cancels three orders of t and
// needs its series up to larger angles than the others.
Eigen::Matrix3d leftJacobianSO3(const Eigen::Vector3d& w) {
  const double t2 = w.squaredNorm();
  double b = 0.5 - t2 / 24;
  double c = 1.0 / 6 - t2 / 120;
  if (t2 > kSmallAngle2) {
    const double t = std::sqrt(t2);
    const double s = std::sin(t / 2) / t;
    b = 2 * s * s;
    c = t2 < 1e-2 ? 1.0 / 6 - t2 / 120 + t2 * t2 / 5040 : (t - std::sin(t)) / (t2 * t);
  }
  const Eigen::Matrix3d W = skew(w);
  return Eigen::Matrix3d::Identity() + b * W + c * W * W;
}

Eigen::Matrix3d rightJacobianSO3(const Eigen::Vector3d& w) { return leftJacobianSO3(-w); }

// I - W/2 + (1/t^2 - cot(t/2)/(2t)) W^2.
Eigen::Matrix3d inverseLeftJacobianSO3(const Eigen::Vector3d& w) {
  const double t2 = w.squaredNorm();
  // The difference of two poles at 0: its series up to t = 0.1, where the next term is below 1e-12.
  double c = 1.0 / 12 + t2 / 720 + t2 * t2 / 30240;
  if (t2 > 1e-2) {
    const double t = std::sqrt(t2);
    c = 1 / t2 - std::cos(t / 2) / (2 * t * std::sin(t / 2));  // exact up to and beyond t = pi
  }
  const Eigen::Matrix3d W = skew(w);
  return Eigen::Matrix3d::Identity() - 0.5 * W + c * W * W;
}

Eigen::Matrix3d inverseRightJacobianSO3(const Eigen::Vector3d& w) {
  return inverseLeftJacobianSO3(-w);
}

// Not Eigen's FromTwoVectors(): its decomposition for opposite vectors takes seconds to compile.
Eigen::Matrix3d shortestTurn(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d a = from.normalized();
  const Eigen::Vector3d b = to.normalized();
  Eigen::Vector3d v = a.cross(b);
  double w = 1 + a.dot(b);
  if (w < 1 && v.norm() < 1e-8) {  // rounding decides where v points: any axis at a right angle
    w = 0;
    v = a.unitOrthogonal();
  }
  // (1 + cos, sin n) is 2 cos(angle / 2) times the quaternion (cos(angle / 2), sin(angle / 2) n).
  return Eigen::Quaterniond(w, v.x(), v.y(), v.z()).normalized().toRotationMatrix();
}

// The rotation that maximises trace(R' X) (Kabsch 1976): where the nearest orthogonal matrix is a
// reflection, the axis of the least singular value is turned round, which costs least.
Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& R) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d d(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant());
  return svd.matrixU() * d.asDiagonal() * svd.matrixV().transpose();
}

}  // namespace plumbline
