// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "evaluate/results/result_folder.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// The documents of a calibration: calibration.json, camchain-imucam.yaml (camchain.yaml without
/// IMU), imu.yaml, and residuals.csv if `residuals`.
std::vector<ResultFile> calibrationFiles(const CalibrationRecord& record, bool residuals);

/// What a person wants to see on the terminal after a calibration: the parameters with their
/// standard deviations, the errors, and the verdict with every finding that is not good.
std::string calibrationSummary(const CalibrationRecord& record);

}  // namespace plumbline
