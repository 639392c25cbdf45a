// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/frames.h"
#include "calibrator/base/session.h"
#include "calibrator/guidance/guide_frame.h"

namespace plumbline {

struct GuideFramesOptions {
  TimeNs tolerance = FrameOptions().tolerance;  ///< of stamps within a frame [ns]
  /// How long after its stamp an image is there [s]: exposure, transfer, detection. IMU samples
  /// stamped until then arrive with it.
  double arrival_s = 0.05;
};

/// A recording's frames, those without corners as well: one for each that guideFrames() gives.
std::vector<Frame> pairedFrames(const Session& session, const GuideFramesOptions& options = {});

/// A recording as the guide would have got it: every frame, also those in which no target was
/// found, with the IMU samples that arrived since the frame before. The first frame brings those of
/// the second before it.
std::vector<GuideFrame> guideFrames(const Session& session, const GuideFramesOptions& options = {});

/// What a session tells of its sensor. `models` one per camera; empty: the session's own words,
/// pinhole-radtan where it has none (see CameraStageOptions).
GuideRig guideRig(const Session& session, const std::vector<CameraModelPair>& models = {});

/// The session of some of the frames (ascending positions as GuideFrame::index has them), with all
/// IMU samples.
Session sessionOf(const Session& session, const std::vector<GuideFrame>& frames,
                  const std::vector<int>& wanted);

}  // namespace plumbline
