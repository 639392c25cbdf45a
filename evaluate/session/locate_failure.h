// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibrator/base/error.h"
#include "evaluate/calibration/calibrate_session.h"
#include "evaluate/session/load_session.h"

namespace plumbline {

/// The line of a file that starts with `key`, from 1; 0 where there is none.
int lineOf(const std::string& key, const std::string& path);

/// The failure with its message opened by the file that it points at, "FILE:LINE: ..." or
/// "FILE: ...": the line of tagSize in the target's file, no line for the others.
Failure locate(Failure failure, const CalibrateRequest& request, const LoadedSession& loaded);

}  // namespace plumbline
