// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/results.h"
#include "calibrator/guidance/frame_corners.h"
#include "calibrator/guidance/guide_options.h"

namespace plumbline {

/// Batch over frames of the guide: calibrateCameras() as the guide's options have it, from `start`
/// or, where that is empty, from the views alone.
Result<CameraStageResult> calibrateFrames(const GuideRig& rig, const std::vector<KeptFrame>& frames,
                                          const GuideOptions& options,
                                          const std::vector<CameraCalibration>& start = {});

/// Only the frames' poses move; the cameras are given.
Result<CameraStageResult> scoreFrames(const GuideRig& rig, const std::vector<KeptFrame>& frames,
                                      const GuideOptions& options,
                                      const std::vector<CameraCalibration>& cameras);

/// Whether the camera stage started at a wrong minimum, under which every frame may yet have a
/// plausible pose: frames after the start that moved against each other are calibrated by
/// themselves, from nothing, once there are 10, 20 and 40 of them. The estimate was wrong where it
/// leaves 1.25 times the RMSE on them, only poses moved.
class StartCheck {
 public:
  StartCheck(const GuideRig& rig, const GuideOptions& options) : rig_(rig), options_(options) {}

  /// A frame with a plausible pose; whether the frames so far are now to be compared.
  bool isDue(const GuideFrame& frame, const FrameCorners& corners);
  /// What speaks against the cameras; empty: nothing.
  std::optional<std::string> against(const std::vector<CameraCalibration>& cameras) const;
  /// The stage restarts.
  void forget() { frames_.clear(); }

 private:
  GuideRig rig_;
  GuideOptions options_;
  std::vector<KeptFrame> frames_;
};

}  // namespace plumbline
