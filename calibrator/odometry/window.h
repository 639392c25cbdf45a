// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "calibrator/base/results/imu_residuals.h"
#include "calibrator/linear/dense.h"
#include "calibrator/odometry/rig_model.h"
#include "calibrator/residuals/imu_residual.h"

namespace plumbline {

/// The IMU between a frame of the window and the next one.
struct ImuLink {
  TimeNs from = 0, to = 0;  ///< camera clock
  Preintegration motion;    ///< with the biases `at`
  ImuBias at;
  ImuWeight weight;
};

/// A frame of the window.
struct OdometryFrame {
  std::int64_t serial = 0;  ///< its number since the start
  TimeNs t = 0;             ///< camera clock
  ImuState state;           ///< T_FS with F the odometry's world W: gravity along -z
  /// Where the prior was first taken of this frame. Its derivatives stay there, so that what left
  /// the window and what is in it agree on the directions that nothing observes (position, yaw):
  /// Huang, Mourikis, Roumeliotis, "A first-estimates Jacobian EKF", ISER 2008.
  std::optional<ImuState> first_estimate;
  bool keyframe = false;
  bool still = false;           ///< the rig stands: its velocity is zero
  std::optional<ImuLink> link;  ///< to the next frame; empty for the last, or without samples

  const ImuState& point() const { return first_estimate ? *first_estimate : state; }
};

/// A sighting from a frame of the window.
struct LandmarkSighting {
  std::int64_t frame = 0;  ///< its serial
  Sighting seen;
};

/// A point of the scene.
struct Landmark {
  std::optional<Eigen::Vector3d> p_W;  ///< empty until it is triangulated
  std::vector<LandmarkSighting> sightings;
  std::int64_t last_frame = 0;  ///< serial of the last frame that saw it
};

/// Whether a landmark has terms: one ray alone says nothing of the frames.
inline bool isUsed(const Landmark& landmark) {
  return landmark.p_W && landmark.sightings.size() >= 2;
}

/// Terms of a frame's state in the tangent space: pose (6), velocity, biases of gyroscope and
/// accelerometer.
inline constexpr int kState = 15;

/// What left the window still says of the frames in it: f(d), with d the displacements of their
/// states from `points`, kState each, in the order of `frames`.
struct WindowPrior {
  std::vector<std::int64_t> frames;  ///< serials
  std::vector<ImuState> points;
  QuadraticCost cost;
};

/// A fixed-lag window: frames, the landmarks they see, the IMU between them and the prior.
struct Window {
  std::vector<OdometryFrame> frames;           ///< ascending in time
  std::map<std::int64_t, Landmark> landmarks;  ///< by track id
  WindowPrior prior;

  /// Index of a frame; -1 where it has left.
  int indexOf(std::int64_t serial) const;
  /// One that has not.
  const OdometryFrame& frame(std::int64_t serial) const { return frames[indexOf(serial)]; }

  /// Takes out sightings. Landmarks that are left with one lose their place,
  /// those that are left with none go.
  void dropSightings(const std::function<bool(const Landmark&, const LandmarkSighting&)>& drop);
  /// Takes out a frame with its sightings.
  void dropFrame(std::size_t index);
};

/// Displacements of the prior's frames from its points.
Eigen::VectorXd displacements(const Window& window);

/// Weights of the window's terms.
struct WindowModel {
  double cauchy = 2;              ///< scale of the Cauchy loss on a whitened sighting [sigma]
  double still_sigma_m_s = 0.01;  ///< of a standing rig's velocity
};

/// The IMU from `from` to `to` with the given biases; empty where the samples do not cover it, or a
/// gap of more than `max_gap_s` lies within.
std::optional<ImuLink> imuLink(std::span<const ImuSample> samples, const RigModel& rig, TimeNs from,
                               TimeNs to, const ImuBias& bias, double max_gap_s);

inline ImuBias biasOf(const ImuState& state) { return {state.gyro_bias, state.accel_bias}; }

/// The link's motion at other biases, to first order in their change.
Preintegration motionAt(const ImuLink& link, const ImuState& state);

/// The state at the end of a link that begins at `from`.
ImuState predicted(const ImuState& from, const ImuLink& link, double gravity_m_s2);

/// Residual of a sighting of `p_W`, whitened, and its derivative in the pose (2x6, tangent of
/// Transform) and in the point (2x3). Empty where the point is behind the ray's plane.
struct SightingResidual {
  Eigen::Vector2d e;
  Eigen::Matrix<double, 2, 3> J_point;
  Eigen::Matrix<double, 2, 6> J_pose;
};
std::optional<Eigen::Vector2d> sightingError(const Sighting& seen, const RigModel& rig,
                                             const Transform& T_WS, const Eigen::Vector3d& p_W);
/// With derivatives at the pose T_point (first estimates), the error at T_WS.
std::optional<SightingResidual> sightingResidual(const Sighting& seen, const RigModel& rig,
                                                 const Transform& T_WS, const Transform& T_point,
                                                 const Eigen::Vector3d& p_W);

/// The point nearest to the rays of its sightings, where they meet at `min_angle_rad` at least and
/// it lies before all cameras, farther than `min_depth_m` and nearer than `max_depth_m` to the IMU.
struct TriangulationLimits {
  double min_angle_rad = 0.008;
  double min_depth_m = 0.1;
  double max_depth_m = 100;
  double max_error = 5;  ///< of any sighting [sigma]
};
std::optional<Eigen::Vector3d> triangulated(const Window& window, const RigModel& rig,
                                            const std::vector<LandmarkSighting>& sightings,
                                            const TriangulationLimits& limits);

}  // namespace plumbline
