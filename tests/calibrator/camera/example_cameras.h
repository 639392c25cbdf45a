// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/calibration.h"

namespace plumbline::testing {

/// A camera like EuRoC's cam0.
inline Intrinsics radtanCamera() {
  Intrinsics camera;
  camera.distortion_model = DistortionModel::kRadtan;
  camera.resolution = {752, 480};
  camera.projection = Eigen::Vector4d(458.654, 457.296, 367.215, 248.375);
  camera.distortion = Eigen::Vector4d(-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05);
  return camera;
}

/// A camera like TUM-VI's cam0.
inline Intrinsics equidistantCamera() {
  Intrinsics camera;
  camera.distortion_model = DistortionModel::kEquidistant;
  camera.resolution = {512, 512};
  camera.projection = Eigen::Vector4d(190.978, 190.973, 254.932, 256.897);
  camera.distortion = Eigen::Vector4d(0.0034823894, 0.0007150348, -0.0020532361, 0.00020293673);
  return camera;
}

inline std::vector<Intrinsics> allCameras() { return {radtanCamera(), equidistantCamera()}; }

}  // namespace plumbline::testing
