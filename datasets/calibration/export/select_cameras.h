// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/calibration.h"

namespace plumbline {

/// The calibration of the cameras named, in that order, with the first as the new camera 0:
/// T_C0Ci, T_SC0 and the time offset are moved to it. Standard deviations of transforms are dropped
/// unless camera 0 stays camera 0, since their correlations are not known here. All cameras for an
/// empty list. Throws InputError (for `path`) for a name that is not there, or is there twice.
Calibration selectCameras(const Calibration& calibration, const std::vector<std::string>& names,
                          const std::string& path);

}  // namespace plumbline
