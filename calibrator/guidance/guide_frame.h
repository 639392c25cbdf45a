// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"

namespace plumbline {

/// What the guide knows of the sensor before it sees anything.
struct GuideRig {
  struct Camera {
    std::string name;
    Resolution resolution;
    CameraModelPair model;
  };
  AprilGrid target;
  std::vector<Camera> cameras;
  std::optional<ImuNoise> imu;  ///< empty: no IMU, no camera-IMU stage
};

/// All that arrives up to and with one camera frame.
struct GuideFrame {
  int index = 0;                             ///< position in the recording
  TimeNs t = 0;                              ///< stamp, camera 0's clock
  std::vector<std::vector<Corner>> corners;  ///< per camera; ids ascending; empty: no view
  std::vector<ImuSample> imu;  ///< samples since the frame before, ascending; stamps as recorded
};

}  // namespace plumbline
