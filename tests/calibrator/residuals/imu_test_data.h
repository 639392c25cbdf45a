// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include <ceres/jet.h>

#include "calibrator/residuals/imu_residual.h"
#include "tests/calibrator/residuals/imu_oracle.h"

namespace plumbline::test {

/// Smooth rates (up to about 2 rad/s) and forces (up to about 15 m/s^2) on three axes.
inline std::vector<ImuSample> wavySamples(TimeNs start, double rate_hz, double seconds) {
  std::vector<ImuSample> samples;
  const int n = static_cast<int>(std::lround(seconds * rate_hz));
  for (int k = 0; k <= n; ++k) {
    const double t = k / rate_hz;
    const TimeNs stamp = toNanoseconds(t);
    samples.push_back({start + stamp,
                       {1.1 * std::sin(7 * t), -0.8 + std::cos(9 * t), 0.9 * std::sin(5 * t + 1)},
                       {3 * std::cos(11 * t), 9.8 + 2 * std::sin(6 * t), -4 * std::sin(8 * t)}});
  }
  return samples;
}

/// The motion of `oracle` as matrix and vectors in Jets.
template <class T>
oracle::Motion<T> oracleMotion(const std::vector<ImuSample>& samples, const ImuWindow& window,
                               const oracle::Vec3<T>& bg, const oracle::Vec3<T>& ba,
                               const T& offset) {
  std::vector<double> t;
  std::vector<Eigen::Vector3d> gyro, accel;
  for (const ImuSample& s : samples) {
    t.push_back(secondsBetween(window.from, s.t));
    gyro.push_back(s.gyro);
    accel.push_back(s.accel);
  }
  return oracle::integrate<T>(t, gyro, accel, offset, T(window.duration_s()) + offset, bg, ba);
}

/// d (rotation on the right, v, p) / d (gyro bias, accel bias, t_d) by automatic differentiation.
inline Eigen::Matrix<double, 9, 7> ceresJacobian(const std::vector<ImuSample>& samples,
                                                 const ImuWindow& window, const ImuBias& bias) {
  using Jet = ceres::Jet<double, 7>;
  oracle::Vec3<Jet> bg, ba;
  for (int k = 0; k < 3; ++k) {
    bg(k) = Jet(bias.gyro(k), k);
    ba(k) = Jet(bias.accel(k), 3 + k);
  }
  const auto m = oracleMotion<Jet>(samples, window, bg, ba, Jet(window.time_offset_s, 6));
  Eigen::Quaternion<Jet> base(Jet(m.q.w().a), Jet(m.q.x().a), Jet(m.q.y().a), Jet(m.q.z().a));
  const oracle::Vec3<Jet> w = oracle::logQuaternion<Jet>(base.conjugate() * m.q);
  Eigen::Matrix<double, 9, 7> J;
  for (int k = 0; k < 3; ++k) {
    J.row(k) = w(k).v.transpose();
    J.row(3 + k) = m.v(k).v.transpose();
    J.row(6 + k) = m.p(k).v.transpose();
  }
  return J;
}

}  // namespace plumbline::test
