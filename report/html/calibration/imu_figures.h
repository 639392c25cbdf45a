// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/time.h"
#include "report/html/figure.h"
#include "report/records/calibration_record.h"

namespace plumbline::html_internal {

// Of plots over time: `origin` is the stamp where the page's time starts.

/// What the sensors read on average between frames beside what the states predict, with bands of
/// three standard deviations; of long recordings the interval of each run that differs most.
FigureGroup readingFigures(const CameraImuStageResult& stage, TimeNs origin);

/// Gyroscope and accelerometer residuals over time, raw with the band that the samples' noise
/// explains, and normalised, with histograms beside the normal distribution that the assumptions
/// let expect.
std::vector<FigureGroup> imuResidualFigures(const CameraImuStageResult& stage, TimeNs origin);

/// Both biases over time, each axis about its mean.
FigureGroup biasFigures(const CameraImuStageResult& stage, TimeNs origin);

/// What a check says of the noise density that was assumed, with what the verdict made of it; null
/// where the verdict has no finding on it.
std::string densityRemark(const std::string& sensor, const ImuNoiseCheck& check,
                          const Finding* judged);

}  // namespace plumbline::html_internal
