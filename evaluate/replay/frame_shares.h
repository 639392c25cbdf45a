// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calibrator/base/error.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera/batch.h"

namespace plumbline {

/// What each frame of a session tells of its cameras, all at one estimate, so that they add up.
struct FrameShares {
  std::vector<Frame> frames;                 ///< those with a pose, ascending in time
  std::vector<Eigen::MatrixXd> information;  ///< one per frame, its own pose eliminated
};

/// At given cameras; only poses are estimated (scoreCameras()). Rows: all intrinsics, then all
/// T_C0Ci. Fails where scoreCameras() does.
Result<FrameShares> frameShares(const Session& session,
                                const std::vector<CameraCalibration>& cameras,
                                const CameraStageOptions& options);

}  // namespace plumbline
