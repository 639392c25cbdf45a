// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/guidance/guide_frame.h"
#include "calibrator/guidance/guide_options.h"

namespace plumbline {

/// Corners of one frame, per camera; ids ascending; empty where a camera has no view.
using FrameCorners = std::vector<std::vector<Corner>>;

/// A frame that the camera stage has accepted.
struct KeptFrame {
  TimeNs t = 0;
  FrameCorners corners;
};

/// Batch over frames of the guide: calibrateCameras() as the options of the guide have it, from
/// `start` or, where that is empty, from the views alone.
Result<CameraStageResult> calibrateFrames(const GuideRig& rig, const std::vector<KeptFrame>& frames,
                                          const GuideOptions& options,
                                          const std::vector<CameraCalibration>& start = {});

}  // namespace plumbline
