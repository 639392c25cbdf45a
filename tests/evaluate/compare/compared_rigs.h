// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibrator/base/calibration.h"
#include "calibrator/base/transform.h"

namespace plumbline::test {

/// A stereo camera with an IMU, as EuRoC's.
inline Calibration stereo() {
  Calibration c;
  for (int i = 0; i < 2; ++i) {
    CameraCalibration camera;
    camera.name = "cam" + std::to_string(i);
    camera.intrinsics.resolution = {752, 480};
    camera.intrinsics.projection = Eigen::Vector4d(458, 457, 367, 248);
    camera.intrinsics.distortion = Eigen::Vector4d(-0.28, 0.07, 2e-4, 1e-5);
    c.cameras.push_back(camera);
  }
  c.cameras[1].T_C0Ci = Transform(expSO3({0.01, -0.02, 0.003}), {0.11, 0.001, -0.002});
  c.imu.emplace();
  c.imu->T_SC0 = Transform(expSO3({0.02, -0.01, 1.55}), {-0.02, -0.065, 0.01});
  c.imu->time_offsets = {{1e-3}};
  return c;
}

inline Calibration moved() {
  Calibration c = stereo();
  c.cameras[0].intrinsics.projection[0] += 0.5;
  c.cameras[1].T_C0Ci.t += Eigen::Vector3d(3e-4, 0, 4e-4);
  c.imu->T_SC0.R = expSO3({0, 0, 1e-3}) * c.imu->T_SC0.R;
  c.imu->time_offsets[0].s -= 2e-4;
  return c;
}

}  // namespace plumbline::test
