// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/time.h"
#include "calibrator/base/transform.h"

namespace plumbline {

/// Where one camera saw a point of the scene. The same id is the same point, in every frame and
/// camera; ids are never used again for another point.
struct TrackPoint {
  std::int64_t id = 0;
  int camera = 0;
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();  ///< [px]; the first pixel's centre is (0, 0)
};

/// All that the cameras saw at one stamp of the camera's clock: what the odometry's front end makes
/// of images, or a simulation of a scene, and what its back end works on.
struct FrameTracks {
  TimeNs t = 0;
  std::vector<TrackPoint> points;
};

/// A sighting of a point by one camera, prepared once so that no lens model is evaluated in the
/// estimator. With f the unit ray of the pixel and B an orthonormal basis of the plane normal to
/// it, M = d(uv)/d(B) B^T / sigma (2x3): the residual of a point p in the camera's frame is
///   e = M p / |p|,
/// which is the whitened reprojection error to first order, for every lens model, and zero along f.
struct Sighting {
  int camera = 0;
  Eigen::Vector3d f = Eigen::Vector3d::UnitZ();
  Eigen::Matrix<double, 2, 3> M = Eigen::Matrix<double, 2, 3>::Zero();
};

/// A calibration as the odometry uses it: fixed.
struct RigModel {
  std::vector<Intrinsics> cameras;
  std::vector<Transform> T_SC;  ///< one per camera
  ImuNoise noise;
  double time_offset_s = 0;  ///< of camera 0, taken for all: t_imu = t_cam + t_d
  double gravity_m_s2 = 9.80655;

  /// Of the first `cameras` cameras (0: all). Throws InputError for a calibration without IMU or
  /// cameras, or with a noise density that is not positive.
  static RigModel of(const Calibration& calibration, int cameras = 0);

  /// Empty where the lens model has no ray for the pixel.
  std::optional<Sighting> sighting(int camera, const Eigen::Vector2d& uv, double sigma_px) const;
};

}  // namespace plumbline
