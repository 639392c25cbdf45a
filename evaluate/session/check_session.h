// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/error.h"
#include "evaluate/session/load_session.h"

namespace plumbline {

/// The failure with the file that it points at, "FILE:LINE" or "FILE": the line of tagSize in the
/// target's file, no line for the others. `session` is the folder that `loaded` was read from.
Failure locate(Failure failure, const LoadedSession& loaded, const std::string& session);

/// Fills in at which lines of the IMU's table the screened samples stand, where it is a table.
void locateSamples(const LoadedSession& loaded, Screening& screening);

/// Throws InputError at the line of target.yaml that the corners contradict: tagCols where the tags
/// that it puts above each other do not stand in line, tagSpacing where the gaps are further from
/// it than the lens and real corners were seen to feign (15 % with `cameras` empty; 10 % with the
/// cameras of the session, whose distortion is then taken out).
void checkTargetLayout(const LoadedSession& loaded, const std::vector<CameraCalibration>& cameras);

}  // namespace plumbline
