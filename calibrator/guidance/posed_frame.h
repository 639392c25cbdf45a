// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibrator/base/april_grid.h"
#include "calibrator/base/calibration.h"
#include "calibrator/guidance/guide_frame.h"

namespace plumbline {

/// A frame whose corners gave a pose.
struct PosedFrame {
  int index = 0;  ///< position in the recording
  TimeNs t = 0;
  std::vector<std::vector<Corner>> corners;  ///< per camera; empty: too few
  Transform T_FC0;
  bool after_jump = false;  ///< the frames paused before it for too long
};

struct FramePoseOptions {
  int min_corners = 16;  ///< of one camera, for its view to count
  double max_rms_px = 30;
};

/// The frame with the views that show enough, and camera 0's pose by them alone. Empty where they
/// give none, or one that leaves more than max_rms_px.
std::optional<PosedFrame> poseFrame(const GuideFrame& frame, const AprilGrid& target,
                                    const std::vector<CameraCalibration>& cameras,
                                    const FramePoseOptions& options);

}  // namespace plumbline
