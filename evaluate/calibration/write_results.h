// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/calibration_record.h"

namespace plumbline {

/// Name of the records file in a result folder.
inline constexpr const char* kRecordsFile = "records.sqlite";

struct WriteOptions {
  bool report = true;      ///< report.html (the records are always written)
  bool residuals = false;  ///< residuals.csv
};

/// Writes a calibration's results into `out` (made if missing): calibration.json,
/// camchain-imucam.yaml (camchain.yaml without IMU), imu.yaml, records.sqlite, and as asked
/// residuals.csv and report.html. All are rendered and written first, under a hidden folder of
/// `out`, and then renamed together; files of these names that this run does not write are removed.
/// Throws InputError where `out` cannot be written: what was there before is then as it was, and a
/// folder that was not there is gone again.
void writeCalibrationResults(const CalibrationRecord& record, const std::string& out,
                             const WriteOptions& options);

/// Renders the page of a record and writes it, whole or not at all.
void writeCalibrationPage(const CalibrationRecord& record, const std::string& path);

}  // namespace plumbline
