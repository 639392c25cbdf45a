// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"

namespace plumbline {

/// Every camera of the session calibrated by itself, with its models and start of `options`, on the
/// board as the session has it and all its views.
std::vector<Result<CameraStageResult>> calibratedAlone(const Session& session,
                                                       const CameraStageOptions& options);

/// Two cameras whose poses no transform between them joins.
struct CamerasApart {
  std::string first, second;
  double turn_deg = 0;  ///< median angle of R_C1C2 in single frames to its middle one
  int frames = 0;       ///< in which both have a pose
};

/// Of the pairs in which the rotation from one camera to the other, by the poses that each has
/// alone, varies by more than a degree from frame to frame, the one in which it varies most. Pose
/// noise is a tenth of that where views hold a few tags.
std::optional<CamerasApart> camerasApart(const Session& session,
                                         const std::vector<Result<CameraStageResult>>& alone,
                                         const FrameOptions& options);

}  // namespace plumbline
