// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "report/html/section.h"
#include "report/records/calibration_record.h"

namespace plumbline::html_internal {

/// A held calibration's scores: on the recording, K-fold validation, held-out recordings, each with
/// one column per camera, and bars of the RMSE per camera.
Section heldScoresSection(const HeldCalibration& held);

}  // namespace plumbline::html_internal
