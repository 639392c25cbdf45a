// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/imu_bias.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/simulate/rig.h"
#include "calibrator/simulate/simulation_options.h"
#include "calibrator/simulate/trajectory.h"

namespace plumbline {

/// A recording whose truth is known.
struct SimulatedSession {
  Session session;
  Calibration truth;  ///< of the rig, with the rates and time offset that were simulated
  AnalyticTrajectory trajectory;
  TimeNs start_ns = 0;          ///< IMU-clock stamp at which trajectory.at(0) holds
  Eigen::Vector3d gravity_F;    ///< [m/s^2], pointing down
  std::vector<ImuBias> biases;  ///< one per session.imu->samples
  double camera_rate_hz = 0;
  std::vector<TimeNs> frame_stamps;   ///< nominal stamps, camera clock, dropped frames included
  std::vector<ImuState> states;       ///< the truth at frame_stamps
  std::vector<InjectedFault> faults;  ///< those of the options, with what they struck
  /// Per camera and view: the camera in the target's frame, both as they really stood when the
  /// image was exposed. Without faults cameraPose().
  std::vector<std::vector<Transform>> view_poses;

  /// Motion of S at an instant of the IMU's clock.
  MotionState motionAtImuTime(TimeNs t_imu) const;
  /// Motion of S when an image with this stamp was exposed: at t_cam + t_d of the IMU's clock.
  MotionState motionAtCameraTime(TimeNs t_cam) const;
  /// T_FCi when camera i took the image with this stamp.
  Transform cameraPose(int camera, TimeNs t_cam) const;
  /// State of the sensor at a camera stamp; biases between samples are interpolated linearly.
  ImuState stateAt(TimeNs t_cam) const;
  /// F in the world frame W: same origin, gravity along -z of W, x of F in W's x-z plane.
  Transform T_WF() const;
};

/// Simulates the recording of a rig along a trajectory, all in memory.
///
/// Corners: project(T_CiF p_F) at the exposure's true time plus noise; a tag is seen where all four
/// corners project into the image (border_px inside) and no side is shorter than min_tag_px.
/// IMU at its own stamps, with f the specific force, from the trajectory's closed form:
///   gyro = omega_S + b_g + n_g,  accel = R_SF (a_F - g_F) + b_a + n_a,
/// n white with density * sqrt(rate), b a walk with steps random_walk / sqrt(rate) through the
/// initial bias at start_ns (backwards in time as well).
/// Same arguments, same values; every sensor and effect has random numbers of its own, so that no
/// option shifts another's noise. Faults change what is recorded, not the truth; motionAt...(),
/// cameraPose() and states are without faults. Throws InputError for options out of range or a rig
/// without cameras or IMU.
SimulatedSession simulateSession(const SimulatedRig& rig, const SimulationOptions& options = {});

}  // namespace plumbline
