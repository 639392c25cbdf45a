// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/session.h"
#include "calibrator/base/time.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// What a sensor's stamps (ascending) say of its intervals. An interval above 1.5 times the median
/// is a gap, in which round(interval / median) - 1 samples are missing (one at least). All zero
/// but the count for fewer than two stamps.
SampleIntervals sampleIntervals(const std::string& sensor, const std::vector<TimeNs>& stamps);

/// Fills in sample_intervals and shown_intervals: every camera's views, with corners or without,
/// and the IMU's samples. Of long streams the shortest and the longest interval of each of 400
/// equal runs are shown, so that no gap is lost.
void addSampleIntervals(const Session& session, CalibrationRecord& record);

}  // namespace plumbline
