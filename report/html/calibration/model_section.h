// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "report/html/section.h"
#include "report/records/calibration_record.h"

namespace plumbline::html_internal {

/// The lens models that were tried for each camera, and why one was chosen. For a record with
/// CameraStageResult::models.
Section modelSection(const CameraStageResult& stage);

/// How the halves of the recording differ, block by block of parameters; empty where no stage has
/// compared them.
Section halvesSection(const CalibrationRecord& record);

}  // namespace plumbline::html_internal
