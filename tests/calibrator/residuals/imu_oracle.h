// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// An independent, templated formulation of the inertial residual, written from the equations in the
// headers with quaternions in place of matrices. Scalars may be ceres::Jet.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calibrator/residuals/imu_residual.h"

namespace plumbline::oracle {

template <class T>
using Vec3 = Eigen::Matrix<T, 3, 1>;

template <class T>
Eigen::Quaternion<T> expQuaternion(const Vec3<T>& w) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  const T n2 = w.squaredNorm();
  if (n2 < T(1e-16)) {
    const Vec3<T> half = w * T(0.5);
    return Eigen::Quaternion<T>(T(1) - n2 / T(8), half.x(), half.y(), half.z());
  }
  const T n = sqrt(n2);
  const Vec3<T> axis = w * (sin(n / T(2)) / n);
  return Eigen::Quaternion<T>(cos(n / T(2)), axis.x(), axis.y(), axis.z());
}

template <class T>
Vec3<T> logQuaternion(const Eigen::Quaternion<T>& q) {
  using std::atan2;
  using std::sqrt;
  const T sign = q.w() < T(0) ? T(-1) : T(1);
  const Vec3<T> v = sign * q.vec();
  const T n2 = v.squaredNorm();
  if (n2 < T(1e-20)) return v * (T(2) / (sign * q.w()));
  const T n = sqrt(n2);
  return v * (T(2) * atan2(n, sign * q.w()) / n);
}

template <class T>
struct Motion {
  Eigen::Quaternion<T> q = Eigen::Quaternion<T>::Identity();
  Vec3<T> v = Vec3<T>::Zero();
  Vec3<T> p = Vec3<T>::Zero();
};

/// Pre-integration over [start, end] seconds of the IMU's clock.
template <class T>
Motion<T> integrate(const std::vector<double>& t, const std::vector<Eigen::Vector3d>& gyro,
                    const std::vector<Eigen::Vector3d>& accel, const T& start, const T& end,
                    const Vec3<T>& bg, const Vec3<T>& ba) {
  const auto at = [&](const std::vector<Eigen::Vector3d>& x, std::size_t k, const T& time) {
    const T s = (time - T(t[k])) / T(t[k + 1] - t[k]);
    return Vec3<T>(x[k].template cast<T>() * (T(1) - s) + x[k + 1].template cast<T>() * s);
  };
  Motion<T> m;
  std::size_t k = 0;
  while (T(t[k + 1]) <= start) ++k;
  T now = start;
  for (; now < end; ++k) {
    const T next = T(t[k + 1]) < end ? T(t[k + 1]) : end;
    const T dt = next - now;
    const Vec3<T> w0 = at(gyro, k, now) - bg;
    const Vec3<T> w1 = at(gyro, k, next) - bg;
    const Vec3<T> theta = (w0 + w1) * (dt / T(2)) + w0.cross(w1) * (dt * dt / T(12));
    const Eigen::Quaternion<T> q1 = m.q * expQuaternion<T>(theta);
    const Vec3<T> f0 = m.q * Vec3<T>(at(accel, k, now) - ba);
    const Vec3<T> f1 = q1 * Vec3<T>(at(accel, k, next) - ba);
    m.p += m.v * dt + (f0 * T(2) + f1) * (dt * dt / T(6));
    m.v += (f0 + f1) * (dt / T(2));
    m.q = q1;
    now = next;
  }
  return m;
}

}  // namespace plumbline::oracle
