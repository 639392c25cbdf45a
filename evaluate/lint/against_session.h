// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/session.h"
#include "calibrator/batch/camera_imu/stage.h"
#include "evaluate/lint/rules.h"

namespace plumbline::lint {

/// Poses T_FC of one camera of a session by its corners alone (camera 0 of each CameraPose is this
/// camera).
std::vector<CameraPose> posesOf(const Session& session, std::size_t camera,
                                const Intrinsics& intrinsics);

/// RMS reprojection error [px] of a camera's corners under those poses, over every few views.
double reprojectionRms(const Session& session, std::size_t camera, const Intrinsics& intrinsics,
                       const std::vector<CameraPose>& poses);

/// Cameras that are exchanged, or whose baseline is the wrong way round, by the corners.
std::vector<Finding> orderFault(const LintedCalibration& linted, const Session& session);

}  // namespace plumbline::lint
