// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/calibration.h"
#include "evaluate/session/load_session.h"

namespace plumbline {

/// Throws InputError at the line of target.yaml that the corners contradict: tagCols where the tags
/// that it puts above each other do not stand in line, tagSpacing where the gaps are further from
/// it than the lens and real corners were seen to feign (15 % with `cameras` empty; 10 % with the
/// cameras of the session, whose distortion is then taken out).
void checkTargetLayout(const LoadedSession& loaded, const std::vector<CameraCalibration>& cameras);

}  // namespace plumbline
