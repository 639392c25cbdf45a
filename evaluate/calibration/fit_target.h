// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/batch/board/joint_target.h"
#include "calibrator/batch/camera/batch.h"
#include "evaluate/results/progress.h"
#include "evaluate/session/load_session.h"

namespace plumbline {

/// What `plumbline target fit` is asked to do.
struct TargetFitRequest {
  std::vector<LoadRequest> sessions;
  CameraStageOptions camera;  ///< of every session's cameras; `target` does not matter
};

/// What a session says of the board that all of them together show.
enum class BoardAgreement {
  kSame,           ///< its terms differ by no more than chance (TargetMember::agrees())
  kSamePredicted,  ///< by more, but its own terms predict frames that it did not see no better
  kOther,          ///< by more, and its own predict them better by two deviations
};

struct SessionsTarget {
  AprilGrid board;                 ///< with the joint shape
  std::vector<std::string> names;  ///< of the sessions
  std::vector<BoardAgreement> agreement;
  JointTarget joint;
};

/// Calibrates the cameras of every session with the board's terms free, and joins what they say of
/// the board (joinTargets()), with deviations at the noise that each recording's corners have. A
/// session that differs by more than chance is calibrated again on the joint board. Throws
/// InputError for bad input, or sessions whose target.yaml differ; fails as calibrateCameras()
/// does.
Result<SessionsTarget> fitTargetOverSessions(const TargetFitRequest& request,
                                             const ProgressSink& progress);

/// The joint terms with their deviations, and session by session whether it shows that board.
std::string jointTargetText(const SessionsTarget& fit);

}  // namespace plumbline
