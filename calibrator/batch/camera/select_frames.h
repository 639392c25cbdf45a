// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/batch/camera/batch.h"
#include "calibrator/batch/camera/problem.h"

namespace plumbline {

/// The frames of a solved problem that a selection keeps, ascending; see ViewSelectionOptions. By
/// predicted error all of them where they do not determine the cameras, or none fits.
std::vector<int> selectFrames(const CameraProblem& problem, const CameraEstimate& estimate,
                              const ViewSelectionOptions& options);

}  // namespace plumbline
