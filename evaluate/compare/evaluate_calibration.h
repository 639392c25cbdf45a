// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "evaluate/compare/score.h"
#include "evaluate/workflow/load_session.h"
#include "evaluate/workflow/progress.h"
#include "report/records/calibration_record.h"
#include "report/records/comparison_record.h"

namespace plumbline {

/// What `plumbline evaluate calibration` is asked to do.
struct EvaluateCalibrationRequest {
  std::string calibration;  ///< file: ours, Kalibr's, yac's
  LoadRequest load;         ///< of the session
  /// Folders of sessions that the calibration has not seen; read as `load` says, whole.
  std::vector<std::string> held_out;
  ScoreOptions score;
  Provenance provenance;  ///< version, command, options and date; input and hash are filled in
};

/// A calibration's scores, the session's first.
struct CalibrationEvaluation {
  std::string label;  ///< name of the calibration's file
  Calibration calibration;
  Provenance provenance;
  Assumptions assumptions;
  std::vector<CalibrationScore> scores;
};

/// Reads, detects and scores. Fails where the calibration gives the session no score at all; throws
/// InputError for bad input.
Result<CalibrationEvaluation> evaluateCalibration(const EvaluateCalibrationRequest& request,
                                                  const ProgressSink& progress);

}  // namespace plumbline
