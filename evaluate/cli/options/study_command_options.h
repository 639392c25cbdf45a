// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "evaluate/study/definition/definition.h"

namespace plumbline {

// Options of commands that a study's definition states, as the commands' own lines take them: what
// they would refuse in the night is refused before it begins. Both throw InputError.

/// Of `plumbline calibrate`.
void checkCalibrateOptions(const StudyCommandOptions& options);

/// How a trajectory's errors are measured: of `plumbline evaluate trajectory`.
void checkTrajectoryOptions(const StudyCommandOptions& options);

}  // namespace plumbline
