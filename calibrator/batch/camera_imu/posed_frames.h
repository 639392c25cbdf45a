// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/frames.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/batch/corners.h"
#include "calibrator/initialise/angular_rates.h"

namespace plumbline {

/// Frames with a pose of their own, before the IMU has a say.
struct PosedFrames {
  std::vector<Frame> frames;
  std::vector<CameraPose> poses;
  int without_pose = 0;  ///< frames left out
  /// Corners to be left out: of misplaced tags, and grazing ones; see calibrator/initialise.
  std::vector<CornerPlace> rejected;
  Screening screening;  ///< of the views

  std::vector<TimeNs> stamps() const;
};
/// Pairs the session's views and finds each frame's pose from its corners alone: least squares from
/// a homography, and where that leaves corners far off, the best of several starts under a
/// redescending loss.
PosedFrames poseFrames(const Session& session, const std::vector<PackedCorners>& corners,
                       const std::vector<CameraCalibration>& cameras,
                       const CameraImuOptions& options);

}  // namespace plumbline
