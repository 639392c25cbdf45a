// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/base/time.h"
#include "calibrator/simulate/faults/fault.h"
#include "calibrator/simulate/rig.h"
#include "calibrator/simulate/trajectory.h"

namespace plumbline {

/// What is recorded and how it is disturbed. The defaults are a plausible noisy recording.
struct SimulationOptions {
  std::uint64_t seed = 1;        ///< of all noise; the motion has its own, trajectory.seed
  TrajectoryOptions trajectory;  ///< motion of the rig
  AprilGrid target;
  double duration_s = 60;                       ///< first to last frame, about
  std::optional<double> camera_rate_hz;         ///< the rig's unless given
  std::optional<double> imu_rate_hz;            ///< the rig's unless given
  std::optional<double> time_offset_s;          ///< t_imu = t_cam + t_d; the rig's unless given
  TimeNs start_ns = 1'400'000'000'123'456'789;  ///< stamp of the first frame
  double imu_margin_s = 0.5;  ///< IMU samples before the first and after the last exposure;
                              ///< negative: the first and last exposures are not covered

  double corner_sigma_px = 0.2;  ///< standard deviation of u and of v; 0: exact
  double outlier_fraction = 0;   ///< probability that a corner is displaced grossly, [0, 1]
  double outlier_px = 10;        ///< outliers move by 0.5 to 1.5 times this, in any direction
  double dropped_fraction = 0;   ///< probability that a camera loses a frame, [0, 1]
  double stamp_jitter_s = 0;     ///< each camera's exposures differ from the common instants by
                                 ///< up to half of this; stamped with their own times
  double border_px = 5;          ///< tags that come closer to the image's border are not seen
  double min_tag_px = 8;         ///< nor are tags with a side shorter than this

  bool imu_noise = true;  ///< white noise and bias walk of the rig's densities; false: exact
  Eigen::Vector3d initial_gyro_bias{0.004, -0.002, 0.003};  ///< at start_ns [rad/s]
  Eigen::Vector3d initial_accel_bias{0.05, -0.03, 0.08};    ///< at start_ns [m/s^2]
  Eigen::Vector3d down_F{0.03, -1.0,
                         -0.05};  ///< direction of gravity in F, any length; not along x

  std::vector<Fault> faults;  ///< what is wrong with the recording; checked by simulateSession()

  /// Throws InputError naming the field that is out of its range.
  void check() const;
};

/// A recording whose truth is known.
struct SimulatedSession {
  Session session = {};
  Calibration truth;  ///< of the rig, with the rates and time offset that were simulated
  AnalyticTrajectory trajectory;
  TimeNs start_ns = 0;               ///< IMU-clock stamp at which trajectory.at(0) holds
  Eigen::Vector3d gravity_F;         ///< [m/s^2], pointing down
  std::vector<ImuBias> biases = {};  ///< one per session.imu->samples
  double camera_rate_hz = 0;
  std::vector<TimeNs> frame_stamps;   ///< nominal stamps, camera clock, dropped frames included
  std::vector<ImuState> states = {};  ///< the truth at frame_stamps
  std::vector<InjectedFault> faults = {};  ///< those of the options, with what they struck
  /// Per camera and view: the camera in the target's frame, both as they really stood when the
  /// image was exposed. Without faults cameraPose().
  std::vector<std::vector<Transform>> view_poses = {};

  /// Motion of S at an instant of the IMU's clock.
  MotionState motionAtImuTime(TimeNs t_imu) const {
    return trajectory.at(secondsBetween(start_ns, t_imu));
  }
  /// Motion of S when an image with this stamp was exposed: at t_cam + t_d of the IMU's clock.
  MotionState motionAtCameraTime(TimeNs t_cam) const {
    return trajectory.at(secondsBetween(start_ns, t_cam) + truth.imu->timeOffset());
  }
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
/// cameraPose() and states are without faults. Throws InputError for options out of range, a rig
/// without cameras or IMU, or where no IMU sample is left.
SimulatedSession simulateSession(const SimulatedRig& rig, const SimulationOptions& options = {});

/// The same along any motion, with gravity_F [m/s^2] pointing down: rig, clocks, IMU and states,
/// without a view. `options.target` and `options.trajectory` are not looked at.
SimulatedSession simulateMotion(const SimulatedRig& rig, AnalyticTrajectory trajectory,
                                const Eigen::Vector3d& gravity_F, const SimulationOptions& options);

/// The stream of a camera without views, as its calibration describes it.
CameraStream emptyStream(const CameraCalibration& camera);

/// What samples and their biases are, and become.
struct ImuRecording {
  std::vector<ImuSample> samples;
  std::vector<ImuBias> biases;  ///< one per sample
};

/// IMU samples with the biases that are in them.
struct SimulatedImu : ImuRecording {
  std::vector<std::vector<TimeNs>> fault_stamps;  ///< see disturbSamples()
};

/// Samples of an IMU on `trajectory`, see simulateSession(). `imu` states the true offset and
/// densities, with noise.rate_hz the rate; `gravity_F` points down [m/s^2].
SimulatedImu simulateImu(const AnalyticTrajectory& trajectory, const ImuCalibration& imu,
                         const Eigen::Vector3d& gravity_F, const SimulationOptions& options);

/// Corners of the tags that a camera at T_FC sees, exact, ids ascending; which tags those are says
/// simulateSession(). Empty where the camera is behind the target.
std::vector<Corner> visibleCorners(const Intrinsics& camera, const Transform& T_FC,
                                   const SimulationOptions& options);

/// Where a camera sees a corner of the target that lies at p_F, as a detector has it [px]; empty
/// where it cannot.
using CornerProjection =
    std::function<std::optional<Eigen::Vector2d>(int corner_id, const Eigen::Vector3d& p_F)>;

/// The same for any way of seeing corners.
std::vector<Corner> visibleCorners(const Resolution& resolution, const CornerProjection& project,
                                   const SimulationOptions& options);

/// Stamps that camera `index` gives its frames: the nominal ones with jitter, less those dropped.
/// Each stamp comes with the frame's number, which selects its random numbers.
struct FrameStamp {
  std::uint64_t frame = 0;
  TimeNs t = 0;
};
std::vector<FrameStamp> simulateStamps(const std::vector<TimeNs>& nominal, int index,
                                       const SimulationOptions& options);

/// Adds noise and outliers to the corners of one camera's frame. Outliers are kept in the image;
/// corners that noise takes out of it are lost.
void disturbCorners(std::vector<Corner>& corners, const Resolution& resolution, int camera,
                    std::uint64_t frame, const SimulationOptions& options);

}  // namespace plumbline
