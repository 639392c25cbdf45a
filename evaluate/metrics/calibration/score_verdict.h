// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluate/metrics/verdict.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// What the scores of a calibration that was held fixed say: its errors over the image on the
/// recording, with the thresholds of a calibration's own verdict, and the scores that could not be
/// had. The headline leads with its RMSE on every session, held out where it is known to be.
/// For a record with `held`. `unused_shape` is the file of the board's shape that the calibration
/// came with, where the board was taken as stated all the same ("": none).
Verdict scoreVerdict(const CalibrationRecord& record, const std::string& unused_shape = "",
                     const VerdictThresholds& thresholds = {});

}  // namespace plumbline
