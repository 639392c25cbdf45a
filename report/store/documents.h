// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "report/records/calibration_record.h"

namespace plumbline::store_internal {

/// The small parts of a record as JSON; arrays of samples, frames and states are not in it. Numbers
/// that JSON cannot say (not finite) are the words "nan", "inf", "-inf". Reading throws
/// std::runtime_error (or nlohmann's exceptions, which are such) on anything unexpected.
std::string headDocument(
    const CalibrationRecord& record);  ///< assumptions, target, counts, spreads
void readHeadDocument(const std::string& json, CalibrationRecord& record);

std::string cameraDocument(const CameraStageResult& stage);
CameraStageResult readCameraDocument(const std::string& json);

std::string cameraImuDocument(const CameraImuStageResult& stage);
CameraImuStageResult readCameraImuDocument(const std::string& json);

}  // namespace plumbline::store_internal
