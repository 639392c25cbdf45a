// SPDX-License-Identifier: BSD-3-Clause
#include "calibrator/simulate/trajectory.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibrator/camera/camera.h"
#include "calibrator/simulate/random_stream.h"

namespace plumbline {
namespace {

/// Reaches mean +- amplitude (+-10 %), slowest term at base_hz (+-10 %) times the pace. The terms
/// are no multiples of each other, nor are the channels: the motion does not repeat.
SumOfSinusoids wandering(RandomStream& random, double pace, double mean, double amplitude,
                         double base_hz) {
  constexpr std::array<double, SumOfSinusoids::kTerms> kShare{0.6, 0.3, 0.1};
  constexpr std::array<double, SumOfSinusoids::kTerms> kHarmonic{1.0, 1.9, 3.1};
  SumOfSinusoids s;
  s.mean = mean;
  const double scale = amplitude * random.uniform(0.9, 1.1);
  for (int i = 0; i < SumOfSinusoids::kTerms; ++i) {
    const double hz = base_hz * kHarmonic[i] * random.uniform(0.9, 1.1) * pace;
    s.amplitude[i] = scale * kShare[i];
    s.omega[i] = 2 * std::numbers::pi * hz;
    s.phase[i] = random.uniform(0, 2 * std::numbers::pi);
  }
  return s;
}

/// The lens without the polynomials of its distortion; an equidistant one's first term, the angle
/// itself, stays.
Intrinsics withoutPolynomials(Intrinsics camera) {
  if (camera.distortion_model == DistortionModel::kFov) return camera;
  camera.distortion.setZero();
  if (camera.distortion_model == DistortionModel::kEquidistant) return camera;
  camera.distortion_model = DistortionModel::kNone;
  camera.distortion.resize(0);
  return camera;
}

/// The rig's centre between its cameras, with the orientation of camera 0, in camera 0.
Transform rigCentre(const std::vector<CameraCalibration>& cameras) {
  Transform T_C0B;
  for (const CameraCalibration& c : cameras) T_C0B.t += c.T_C0Ci.t;
  T_C0B.t /= static_cast<double>(cameras.size());
  return T_C0B;
}

}  // namespace

double fillingDistance(const AprilGrid& target, const Intrinsics& camera) {
  const double size = std::max(target.width(), target.height());
  const int side = std::min(camera.resolution.width, camera.resolution.height);
  return std::max(0.3, size * pixelsPerRadian(camera) / side);
}

double halfAngle(const Intrinsics& camera, int axis) {
  // Of every model the last four parameters (Kalibr's order).
  const Eigen::Vector4d fu_fv_pu_pv = camera.projection.tail<4>();
  const double half = 0.5 * (axis == 0 ? camera.resolution.width : camera.resolution.height);
  const Intrinsics lens = withoutPolynomials(camera);
  if (lens.projection_model == ProjectionModel::kPinhole) {
    const double slope = half / fu_fv_pu_pv[axis];
    if (lens.distortion_model == DistortionModel::kEquidistant) return slope;
    if (lens.distortion_model == DistortionModel::kNone) return std::atan(slope);
  }
  // Inwards from the image's side to where the lens images anything.
  for (double share = 1; share > 0.01; share *= 0.97) {
    Eigen::Vector2d uv = fu_fv_pu_pv.tail<2>();
    uv[axis] += share * half;
    if (const auto ray = unproject(lens, uv)) return std::atan2(ray->head<2>().norm(), ray->z());
  }
  return 0;
}

AnalyticTrajectory::AnalyticTrajectory(const AprilGrid& target, const SimulatedRig& rig,
                                       const TrajectoryOptions& options)
    : kind_(options.kind) {
  const Intrinsics& camera = rig.calibration.cameras.front().intrinsics;
  const Transform T_C0S = rig.calibration.imu->T_SC0.inverse();
  const Transform T_C0B = rigCentre(rig.calibration.cameras);
  const double near = fillingDistance(target, camera) * options.distance_ratio;
  const Eigen::Vector2d centre(0.5 * target.width(), 0.5 * target.height());
  // In this order: the channels draw from one stream, and another one in between would change all
  // that follow.
  RandomStream random(options.seed, RandomPurpose::kTrajectory);
  const auto channel = [&](double mean, double amplitude, double base_hz) {
    return wandering(random, options.pace, mean, amplitude, base_hz);
  };
  const double reach = options.reach;
  distance_ = channel(1.4 * near, 0.45 * near * reach, 0.17);
  aim_x_ = channel(centre.x(), 0.15 * target.width() * reach, 0.13);
  aim_y_ = channel(centre.y(), 0.15 * target.height() * reach, 0.11);
  azimuth_ = channel(0, 0.62 * reach, 0.21);
  elevation_ = channel(0, 0.52 * reach, 0.27);
  pan_ = channel(0, 0.60 * halfAngle(camera, 0), 0.23);
  tilt_ = channel(0, 0.55 * halfAngle(camera, 1), 0.19);
  roll_ = channel(0, 0.75, 0.31);
  T_BS_ = T_C0B.inverse() * T_C0S;
  if (kind_ == MotionKind::kFull) return;

  const bool moves = kind_ != MotionKind::kStatic;
  const bool translates = moves && kind_ != MotionKind::kPureRotation;
  // Channels without motion keep their draws, at amplitude 0: kinds of one seed share their phases.
  const double way = translates ? 0.2 * near : 0;
  angle_ = channel(0.1, moves ? 0.4 : 0, 0.27);
  x_ = channel(0, way, 0.23);
  y_ = channel(0, way, 0.19);
  z_ = channel(0, way, 0.29);
  // At rest the rig's centre stands squarely before the target's.
  const Transform T_FRig(facingTarget(), {centre.x(), centre.y(), 1.3 * near});
  const bool by_camera = kind_ == MotionKind::kFrontoParallel;
  T_FB0_ = T_FRig * T_C0B.inverse() * (by_camera ? Transform() : T_C0S);
  T_BS_ = by_camera ? T_C0S : Transform();
  // About the optical axis alone, so that the camera keeps facing the target.
  axis_B_ = by_camera ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d(options.axis_S.normalized());
}

MotionState AnalyticTrajectory::at(double t_s) const {
  if (flight_) return flight_->at(t_s);
  return attached(kind_ == MotionKind::kFull ? orbit(t_s) : axisBound(t_s), T_BS_);
}

MotionState AnalyticTrajectory::orbit(double t_s) const {
  using Eigen::Vector3d;
  const RotationMotion facing{facingTarget(), Vector3d::Zero(), Vector3d::Zero()};
  const RotationMotion around = facing * rotationAbout(Vector3d::UnitY(), azimuth_.at(t_s)) *
                                rotationAbout(Vector3d::UnitX(), elevation_.at(t_s));
  // The orbit looks at the aim along u; pan, tilt and roll turn the head and leave the place as it
  // is.
  const RotationMotion head = around * rotationAbout(Vector3d::UnitY(), pan_.at(t_s)) *
                              rotationAbout(Vector3d::UnitX(), tilt_.at(t_s)) *
                              rotationAbout(Vector3d::UnitZ(), roll_.at(t_s));
  // The line of sight u = R e_z and its derivatives; position = aim - d u.
  const Vector3d e = Vector3d::UnitZ();
  const Vector3d spin = around.omega.cross(e);
  const Vector3d u = around.R * e;
  const Vector3d du = around.R * spin;
  const Vector3d ddu = around.R * (around.alpha.cross(e) + around.omega.cross(spin));
  const ScalarMotion d = distance_.at(t_s), ax = aim_x_.at(t_s), ay = aim_y_.at(t_s);
  return {.T_FB = {head.R, Vector3d(ax.x, ay.x, 0) - d.x * u},
          .v_F = Vector3d(ax.dx, ay.dx, 0) - d.dx * u - d.x * du,
          .a_F = Vector3d(ax.ddx, ay.ddx, 0) - d.ddx * u - 2 * d.dx * du - d.x * ddu,
          .omega_B = head.omega,
          .alpha_B = head.alpha};
}

MotionState AnalyticTrajectory::axisBound(double t_s) const {
  const ScalarMotion x = x_.at(t_s), y = y_.at(t_s), z = z_.at(t_s);
  const RotationMotion turn = rotationAbout(axis_B_, angle_.at(t_s));
  // Coordinates along the axes that B has at rest; planar without that along the axis it turns
  // about.
  Eigen::Matrix3d allowed = T_FB0_.R;
  if (kind_ == MotionKind::kPlanar) {
    allowed *= Eigen::Matrix3d::Identity() - axis_B_ * axis_B_.transpose();
  }
  return {.T_FB = {T_FB0_.R * turn.R, T_FB0_.t + allowed * Eigen::Vector3d(x.x, y.x, z.x)},
          .v_F = allowed * Eigen::Vector3d(x.dx, y.dx, z.dx),
          .a_F = allowed * Eigen::Vector3d(x.ddx, y.ddx, z.ddx),
          .omega_B = turn.omega,
          .alpha_B = turn.alpha};
}

}  // namespace plumbline
