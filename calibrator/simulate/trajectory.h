// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/enum_words.h"
#include "calibrator/simulate/flight_motion.h"
#include "calibrator/simulate/rig.h"

namespace plumbline {

/// How the rig moves. All but kFull leave parameters unobservable, on purpose.
enum class MotionKind {
  kFull,                ///< excites every axis; views tilted, rolled, near and far
  kPureRotation,        ///< about `axis_S` through the IMU, which stays in place
  kSingleAxisRotation,  ///< about `axis_S` only, while the IMU translates along all axes
  kPlanar,              ///< about `axis_S`, translating only perpendicular to it
  kStatic,              ///< no motion
  kFrontoParallel,      ///< camera 0 faces the target squarely, translating and rolling
};
constexpr std::array<const char*, 6> enumWords(MotionKind /*of*/) {
  return {"full", "pure-rotation", "single-axis", "planar", "static", "fronto-parallel"};
}

struct TrajectoryOptions {
  MotionKind kind = MotionKind::kFull;
  Eigen::Vector3d axis_S = Eigen::Vector3d::UnitY();  ///< rotation axis in S, for the three kinds
  std::uint64_t seed = 1;     ///< phases, and +-10 % of every amplitude and frequency
  double pace = 1;            ///< multiplies every frequency; 1: at most about 3 rad/s, 5 m/s^2
  double distance_ratio = 1;  ///< multiplies the distance to the target
  double reach = 1;           ///< multiplies the ways of kFull; 0: the rig's centre stays in place
};

/// Distance at which the target's longer side would fill the shorter side of the image, were the
/// image as large everywhere as about its optical axis (pixelsPerRadian()); at least 0.3 m [m].
double fillingDistance(const AprilGrid& target, const Intrinsics& camera);

/// Half of the angle that the image spans along u (axis 0) or v (1), for pan and tilt [rad]. The
/// polynomials of a distortion are left out, and so is what the lens does not image.
double halfAngle(const Intrinsics& camera, int axis);

/// A smooth motion of a rig in front of a target, known in closed form: sums of sinusoids in
/// rotation angles and coordinates, so every derivative is analytic and no integrator is involved.
///
/// kFull: the rig (orientation of camera 0, origin between the cameras) orbits an aim point that
/// wanders about the target's centre: azimuth up to 39 deg and elevation up to 33 deg around the
/// target, distance 0.9 to 1.9 times the one that fills the image's height; pan and tilt move the
/// target across the image, roll of up to 47 deg about the optical axis.
class AnalyticTrajectory {
 public:
  AnalyticTrajectory(const AprilGrid& target, const SimulatedRig& rig,
                     const TrajectoryOptions& options = {});
  /// The motion of a flight in place of one before a target.
  explicit AnalyticTrajectory(FlightMotion flight) : flight_(std::move(flight)) {}

  /// State of the IMU frame S in F, t_s seconds after the start in the IMU's clock. Any t_s.
  MotionState at(double t_s) const;

 private:
  MotionState orbit(double t_s) const;      // kFull
  MotionState axisBound(double t_s) const;  // the others

  std::optional<FlightMotion> flight_;
  MotionKind kind_ = MotionKind::kFull;
  // kFull: frame B is the rig's centre. The others: B is S (kFrontoParallel: camera 0).
  Transform T_BS_;
  SumOfSinusoids azimuth_, elevation_, distance_, aim_x_, aim_y_, pan_, tilt_, roll_;
  // The others only.
  Transform T_FB0_;
  Eigen::Vector3d axis_B_ = Eigen::Vector3d::UnitY();
  SumOfSinusoids angle_, x_, y_, z_;
};

}  // namespace plumbline
