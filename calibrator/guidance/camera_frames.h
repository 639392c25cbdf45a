// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/problem.h"
#include "calibrator/guidance/guide_options.h"

namespace plumbline {

/// Corners of one frame, per camera; ids ascending; empty where a camera has no view.
using FrameCorners = std::vector<std::vector<Corner>>;

/// The views of a frame that hold at least so many corners; the others are empty.
FrameCorners usableViews(const GuideFrame& frame, std::size_t cameras, int min_corners);

/// No camera has a view.
bool seesNothing(const FrameCorners& corners);

/// Whether some camera's view moved by more than `least_px` (mean corner distance), or shows other
/// parts of the target, or is there when it was not before.
bool hasMoved(const FrameCorners& before, const FrameCorners& now, double least_px);

/// T_FC0 from one frame's corners at known cameras, from nothing; empty where what remains is more
/// than 1.5 % of the image's width.
std::optional<Transform> poseOf(const AprilGrid& target, const CameraEstimate& cameras,
                                const FrameCorners& corners, double cauchy_px);

/// A frame that the camera stage has accepted.
struct KeptFrame {
  int index = 0;  ///< position in the recording
  TimeNs t = 0;
  FrameCorners corners;
};

/// Batch over frames of the guide: calibrateCameras() as the guide's options have it, from `start`
/// or, where that is empty, from the views alone.
Result<CameraStageResult> calibrateFrames(const GuideRig& rig, const std::vector<KeptFrame>& frames,
                                          const GuideOptions& options,
                                          const std::vector<CameraCalibration>& start = {});

/// Only the frames' poses move; the cameras are given.
Result<CameraStageResult> scoreFrames(const GuideRig& rig, const std::vector<KeptFrame>& frames,
                                      const GuideOptions& options,
                                      const std::vector<CameraCalibration>& cameras);

}  // namespace plumbline
