// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/operator/rig_sensors.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "calibrator/base/error.h"
#include "calibrator/base/transform.h"

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
    // Rates and accelerations of the product follow from those of its factors.
    rotation = rotation * shareOf(logSO3(from.R.transpose() * to.R), basis[j]);
  }
  m.T_FB.R = rotation.R;
  m.omega_B = rotation.omega;
  m.alpha_B = rotation.alpha;
  return m;
}

std::vector<std::vector<Corner>> cornersAt(const SimulatedRig& rig, const Transform& T_FC0,
                                           int frame, const SimulationOptions& options) {
  std::vector<std::vector<Corner>> all;
  for (std::size_t c = 0; c < rig.calibration.cameras.size(); ++c) {
    const CameraCalibration& camera = rig.calibration.cameras[c];
    all.push_back(visibleCorners(camera.intrinsics, T_FC0 * camera.T_C0Ci, options));
    disturbCorners(all.back(), camera.intrinsics.resolution, static_cast<int>(c),
                   static_cast<std::uint64_t>(frame), options);
  }
  return all;
}

RigSensors::RigSensors(const SimulatedRig& rig, const SimulationOptions& options)
    : rig_(rig),
      options_(options),
      gravity_F_(rig.calibration.imu->gravity_m_s2 * options.down_F.normalized()),
      frames_(static_cast<int>(std::lround(options.duration_s * rig.camera_rate_hz))) {
  options_.check();
  if (options_.camera_rate_hz || options_.imu_rate_hz || options_.time_offset_s) {
    throw InputError("an operated rig has its own rates and time offset; omit the others");
  }
  if (!options_.faults.empty()) {
    throw InputError("an operated rig has no faults; simulate a session with them");
  }
  // At rest a sensor's readings are its noise, its bias and gravity.
  TrajectoryOptions resting;
  resting.kind = MotionKind::kStatic;
  const AnalyticTrajectory rest(options_.target, rig_, resting);
  const SimulatedImu imu = simulateImu(rest, *rig_.calibration.imu, gravity_F_, options_);
  const Eigen::Vector3d exact = rest.at(0).T_FB.R.transpose() * -gravity_F_;
  // What is left once the exact reading is taken off (a gyroscope at rest reads zero) is noise and
  // bias, and the same along any motion.
  noise_.reserve(imu.samples.size());
  for (const ImuSample& s : imu.samples) noise_.push_back({s.t, s.gyro, s.accel - exact});
}

std::vector<ImuSample> RigSensors::samplesUntil(const SplineMotion& motion, TimeNs t) {
  const Transform T_C0S = rig_.calibration.imu->T_SC0.inverse();
  std::vector<ImuSample> samples;
  for (; taken_ < noise_.size() && noise_[taken_].t <= t; ++taken_) {
    const Noise& noise = noise_[taken_];
    // The spline moves camera 0, and the IMU with it.
    const MotionState m = attached(motion.at(secondsOf(noise.t)), T_C0S);
    samples.push_back({noise.t, m.omega_B + noise.gyro,
                       m.T_FB.R.transpose() * (m.a_F - gravity_F_) + noise.accel});
  }
  return samples;
}

Session RigSensors::emptySession() const {
  Session session;
  session.name = "simulated-" + rig_.name;
  session.target = options_.target;
  session.target.shape = {};  // target.yaml states the grid
  for (const CameraCalibration& camera : rig_.calibration.cameras) {
    session.cameras.push_back(emptyStream(camera));
  }
  session.imu = ImuStream{rig_.calibration.imu->rostopic, rig_.calibration.imu->noise, {}};
  return session;
}

}  // namespace plumbline
