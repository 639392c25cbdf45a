// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/guide_decision.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera_imu/batch.h"
#include "calibrator/guidance/guide_frame.h"
#include "calibrator/guidance/guide_options.h"

namespace plumbline {

/// A replay that has run, for those who judge it. All members outlive the judging.
struct ReplayRun {
  const Session& session;
  const std::vector<GuideFrame>& frames;
  const std::vector<Decision>& decisions;  ///< one per frame
  GuideOptions guide;
  CameraStageOptions camera;    ///< of the batches
  CameraImuOptions camera_imu;  ///< likewise

  /// Positions of the frames that a stage accepted and did not withdraw later, ascending.
  std::vector<int> accepted(GuideStage stage) const;
  /// The decision with which a stage finished; null if it did not.
  const Decision* finish(GuideStage stage) const;
  /// The session of some frames; all views of a frame carry the frame's stamp.
  Session sessionOfFrames(const std::vector<int>& wanted) const;
  /// The same of all frames, or of those from position `first` on.
  Session sessionFrom(int first = 0) const;
};

}  // namespace plumbline
