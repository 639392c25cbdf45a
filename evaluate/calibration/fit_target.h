// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/joint_target.h"
#include "evaluate/results/progress.h"
#include "evaluate/session/load_session.h"

namespace plumbline {

/// What `plumbline target fit` is asked to do.
struct TargetFitRequest {
  std::vector<LoadRequest> sessions;
  CameraStageOptions camera;  ///< of every session's cameras; `target` does not matter
};

struct SessionsTarget {
  AprilGrid board;                 ///< with the joint shape
  std::vector<std::string> names;  ///< of the sessions
  JointTarget joint;
};

/// Calibrates the cameras of every session with the board's terms free, and joins what they say of
/// the board (joinTargets()). Throws InputError for bad input, or sessions whose target.yaml
/// differ; fails as calibrateCameras() does.
Result<SessionsTarget> fitTargetOverSessions(const TargetFitRequest& request,
                                             const ProgressSink& progress);

/// The joint terms with their deviations, and session by session whether it shows that board.
std::string jointTargetText(const SessionsTarget& fit);

}  // namespace plumbline
