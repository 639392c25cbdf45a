// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "report/html/figure.h"
#include "report/records/calibration_record.h"

namespace plumbline::html_internal {

/// Gyroscope and accelerometer residuals over time, raw and normalised, with histograms beside the
/// normal distribution that the assumptions let expect.
std::vector<FigureGroup> imuResidualFigures(const CameraImuStageResult& stage);

/// Both biases over time, each axis about its mean.
FigureGroup biasFigures(const CameraImuStageResult& stage);

/// What a check says of the noise density that was assumed, with what the verdict made of it; null
/// where the verdict has no finding on it.
std::string densityRemark(const std::string& sensor, const ImuNoiseCheck& check,
                          const Finding* judged);

}  // namespace plumbline::html_internal
