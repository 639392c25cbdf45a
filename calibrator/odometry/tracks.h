// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "calibrator/base/time.h"

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

}  // namespace plumbline
