// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "report/html/section.h"
#include "report/records/calibration_record.h"

namespace plumbline::html_internal {

/// The board's own shape as the camera stage found it: what was found, its terms with their
/// deviations, heights tag by tag, displacements corner by corner. For a record with a target_fit.
Section targetSection(const AprilGrid& grid, const CameraStageResult& stage);

}  // namespace plumbline::html_internal
