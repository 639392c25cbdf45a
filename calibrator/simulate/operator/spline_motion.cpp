// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cassert>

#include "calibrator/base/transform.h"
#include "calibrator/simulate/operator/rig_sensors.h"

namespace plumbline {
namespace {

/// l_1, l_2, l_3 with their derivatives by time.
std::array<ScalarMotion, 3> cumulativeBasis(double u, double spacing_s) {
  const double u2 = u * u, u3 = u2 * u;
  std::array<ScalarMotion, 3> basis{
      ScalarMotion{(5 + 3 * u - 3 * u2 + u3) / 6, (3 - 6 * u + 3 * u2) / 6, (-6 + 6 * u) / 6},
      ScalarMotion{(1 + 3 * u + 3 * u2 - 2 * u3) / 6, (3 + 6 * u - 6 * u2) / 6, (6 - 12 * u) / 6},
      ScalarMotion{u3 / 6, u2 / 2, u}};
  for (ScalarMotion& l : basis) {
    l.dx /= spacing_s;
    l.ddx /= spacing_s * spacing_s;
  }
  return basis;
}

/// Rotation by `share` of the vector w.
RotationMotion shareOf(const Eigen::Vector3d& w, const ScalarMotion& share) {
  const double angle = w.norm();
  // No rotation has no axis.
  if (angle < 1e-12) return {};
  return rotationAbout(w / angle, {angle * share.x, angle * share.dx, angle * share.ddx});
}

}  // namespace

double SplineMotion::knownUntilS() const {
  return size() < 4 ? 0 : static_cast<double>(size() - 3) * spacing_s_;
}

MotionState SplineMotion::at(double t_s) const {
  assert(size() >= 4);
  const double scaled = std::clamp(t_s / spacing_s_, 0.0, static_cast<double>(size() - 3));
  // The end belongs to the last segment, at u = 1.
  const std::size_t i = std::min(static_cast<std::size_t>(scaled), size() - 4);
  const auto basis = cumulativeBasis(scaled - static_cast<double>(i), spacing_s_);
  RotationMotion rotation{poses_[i].R, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  MotionState m;
  m.T_FB.t = poses_[i].t;
  for (std::size_t j = 0; j < 3; ++j) {
    const Transform &from = poses_[i + j], &to = poses_[i + j + 1];
    const Eigen::Vector3d step = to.t - from.t;
    m.T_FB.t += basis[j].x * step;
    m.v_F += basis[j].dx * step;
    m.a_F += basis[j].ddx * step;
    // Rates and accelerations of the product follow from those of its factors (motion.cpp).
    rotation = rotation * shareOf(logSO3(from.R.transpose() * to.R), basis[j]);
  }
  m.T_FB.R = rotation.R;
  m.omega_B = rotation.omega;
  m.alpha_B = rotation.alpha;
  return m;
}

}  // namespace plumbline
