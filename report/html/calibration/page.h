// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/calibration_record.h"

namespace plumbline {

/// One self-contained HTML page: verdict and findings, key figures, parameters with their
/// uncertainties, correlations, time offset in every tool's sign, 3D scene, reprojection errors,
/// coverage, inertial residuals and biases, provenance. It needs no network and no other file. The
/// sections of a stage that did not run are left out. Equal records give equal bytes. One thread at
/// a time (see report/plots/svg.h).
std::string renderCalibrationPage(const CalibrationRecord& record);

}  // namespace plumbline
