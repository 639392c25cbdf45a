// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/simulate_session.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "calibrator/base/error.h"
#include "calibrator/base/option_check.h"
#include "calibrator/simulate/faults/view_faults.h"

namespace plumbline {
void SimulationOptions::check() const {
  requireWithin(1, 1000, "target.rows", target.rows);
  requireWithin(1, 1000, "target.cols", target.cols);
  requireWithin(1e-6, 100, "target.tag_size", target.tag_size);
  requireWithin(0, 10, "target.spacing", target.spacing);
  requireWithin(1e-3, 1e5, "simulation.duration_s", duration_s);
  requireWithin(1e-3, 1e5, "simulation.camera_rate_hz", camera_rate_hz.value_or(1));
  requireWithin(1e-3, 1e5, "simulation.imu_rate_hz", imu_rate_hz.value_or(1));
  requireWithin(-1e3, 1e3, "simulation.time_offset_s", time_offset_s.value_or(0));
  // Negative: cut off at either end, so that a fifth of the recording is left.
  requireWithin(-0.4 * duration_s, 1e3, "simulation.imu_margin_s", imu_margin_s);
  requireWithin(0, 1e3, "simulation.corner_sigma_px", corner_sigma_px);
  requireWithin(0, 1, "simulation.outlier_fraction", outlier_fraction);
  requireWithin(0, 1e4, "simulation.outlier_px", outlier_px);
  requireWithin(0, 1, "simulation.dropped_fraction", dropped_fraction);
  requireWithin(0, 10, "simulation.stamp_jitter_s", stamp_jitter_s);
  requireWithin(0, 1e4, "simulation.border_px", border_px);
  requireWithin(0, 1e4, "simulation.min_tag_px", min_tag_px);
  requireWithin(1e-6, 1e6, "|down_F|", down_F.norm());
  // Along x of F, T_WF() would have no x axis to start from.
  requireWithin(0, 0.999999, "|down_F.x| / |down_F|", std::abs(down_F.x()) / down_F.norm());
  requireWithin(1e-6, 100, "trajectory.pace", trajectory.pace);
  requireWithin(0.1, 100, "trajectory.distance_ratio", trajectory.distance_ratio);
  requireWithin(0, 100, "trajectory.reach", trajectory.reach);
  requireWithin(1e-6, 1e6, "|trajectory.axis_S|", trajectory.axis_S.norm());
}

namespace {

/// The rig's calibration with the options' overrides.
Calibration trueCalibration(const SimulatedRig& rig, const SimulationOptions& o) {
  if (rig.calibration.cameras.empty() || !rig.calibration.imu) {
    throw InputError("rig '" + rig.name + "' cannot be simulated; it needs a camera and an IMU");
  }
  Calibration truth = rig.calibration;
  truth.imu->noise.rate_hz = o.imu_rate_hz.value_or(truth.imu->noise.rate_hz);
  truth.imu->time_offsets = {{o.time_offset_s.value_or(truth.imu->timeOffset())}};
  return truth;
}

std::vector<TimeNs> nominalStamps(double rate_hz, const SimulationOptions& o) {
  // A frame at least, however short.
  const auto count = std::max<std::int64_t>(1, std::llround(o.duration_s * rate_hz));
  std::vector<TimeNs> stamps;
  for (std::int64_t k = 0; k < count; ++k) {
    // From the number, so that rounding does not add up.
    stamps.push_back(o.start_ns + toNanoseconds(static_cast<double>(k) / rate_hz));
  }
  return stamps;
}

/// Adds the stream of camera `index`, the poses behind its views and what faults struck of it.
void simulateCamera(SimulatedSession& s, int index, const SimulationOptions& o) {
  const CameraCalibration& camera = s.truth.cameras[index];
  CameraStream stream = emptyStream(camera);
  const ViewFaults faulty(s, index, o);
  std::vector<Transform> poses;
  const auto frames = faultyFrames(s, index, o);
  for (const FaultyFrame& frame : frames) {
    poses.push_back(faulty.cameraPose(frame.t_s));
    ImageView view{frame.stamp, faulty.corners(frame)};
    disturbCorners(view.corners, camera.intrinsics.resolution, index, frame.number, o);
    stream.views.push_back(std::move(view));
  }
  // Last, for these faults are of views as recorded.
  disturbViews(stream, frames, index, o, s.faults);
  s.session.cameras.push_back(std::move(stream));
  s.view_poses.push_back(std::move(poses));
}

}  // namespace

CameraStream emptyStream(const CameraCalibration& camera) {
  return {camera.name,
          camera.rostopic,
          camera.intrinsics.resolution,
          toString(camera.intrinsics.projection_model),
          toString(camera.intrinsics.distortion_model),
          {}};
}

Transform SimulatedSession::cameraPose(int camera, TimeNs t_cam) const {
  const Transform T_FC0 = motionAtCameraTime(t_cam).T_FB * truth.imu->T_SC0;
  return T_FC0 * truth.cameras[camera].T_C0Ci;
}

ImuState SimulatedSession::stateAt(TimeNs t_cam) const {
  const MotionState m = motionAtCameraTime(t_cam);
  const std::vector<ImuSample>& samples = session.imu->samples;
  // By the samples' stamps as they came out, faults of the clock included.
  const TimeNs t = t_cam + toNanoseconds(truth.imu->timeOffset());
  // The samples on either side; beyond the ends the outermost bias.
  const auto later = std::upper_bound(samples.begin(), samples.end(), t,
                                      [](TimeNs a, const ImuSample& b) { return a < b.t; });
  const auto count = static_cast<std::ptrdiff_t>(samples.size());
  const auto i1 =
      static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(later - samples.begin(), 0, count - 1));
  const std::size_t i0 = i1 > 0 ? i1 - 1 : 0;
  const double span = secondsBetween(samples[i0].t, samples[i1].t);
  const double w = span > 0 ? std::clamp(secondsBetween(samples[i0].t, t) / span, 0.0, 1.0) : 0;
  return {.T_FS = m.T_FB,
          .v_F = m.v_F,
          .gyro_bias = (1 - w) * biases[i0].gyro + w * biases[i1].gyro,
          .accel_bias = (1 - w) * biases[i0].accel + w * biases[i1].accel};
}

Transform SimulatedSession::T_WF() const {
  const Eigen::Vector3d up_F = -gravity_F.normalized();
  // x of F less its part along the vertical: in W's x-z plane, and level.
  const Eigen::Vector3d side = Eigen::Vector3d::UnitX() - up_F.x() * up_F;
  Eigen::Matrix3d R_WF;
  R_WF.row(0) = side.normalized();
  R_WF.row(2) = up_F;
  R_WF.row(1) = up_F.cross(side.normalized());
  return {R_WF, Eigen::Vector3d::Zero()};
}

SimulatedSession simulateMotion(const SimulatedRig& rig, AnalyticTrajectory trajectory,
                                const Eigen::Vector3d& gravity_F, const SimulationOptions& o) {
  o.check();
  Calibration truth = trueCalibration(rig, o);
  // Here, for only the rig tells which cameras a fault can name.
  check(o.faults, {o.duration_s, static_cast<int>(truth.cameras.size())});
  const double camera_rate_hz = o.camera_rate_hz.value_or(rig.camera_rate_hz);
  SimulatedSession s{.truth = std::move(truth),
                     .trajectory = std::move(trajectory),
                     .start_ns = o.start_ns,
                     .gravity_F = gravity_F,
                     .camera_rate_hz = camera_rate_hz,
                     .frame_stamps = nominalStamps(camera_rate_hz, o)};
  s.session.name = "simulated-" + rig.name;
  SimulatedImu imu = simulateImu(s.trajectory, *s.truth.imu, gravity_F, o);
  if (imu.samples.empty()) {
    throw InputError("no IMU sample is left; expected a shorter gap, or a larger imu_margin_s");
  }
  s.session.imu = ImuStream{s.truth.imu->rostopic, s.truth.imu->noise, std::move(imu.samples)};
  s.biases = std::move(imu.biases);
  for (std::size_t i = 0; i < o.faults.size(); ++i) {
    s.faults.push_back({o.faults[i], std::move(imu.fault_stamps[i])});
  }
  // Last: a state has the biases of the samples about it.
  for (const TimeNs t : s.frame_stamps) s.states.push_back(s.stateAt(t));
  return s;
}

SimulatedSession simulateSession(const SimulatedRig& rig, const SimulationOptions& o) {
  o.check();
  const Calibration truth = trueCalibration(rig, o);
  const Eigen::Vector3d gravity_F = truth.imu->gravity_m_s2 * o.down_F.normalized();
  SimulatedSession s =
      simulateMotion(rig, AnalyticTrajectory(o.target, rig, o.trajectory), gravity_F, o);
  // What target.yaml says; views show o.target, with its shape and at its true size.
  s.session.target = statedTarget(o);
  for (int i = 0; i < static_cast<int>(s.truth.cameras.size()); ++i) {
    simulateCamera(s, i, o);
  }
  return s;
}

}  // namespace plumbline
