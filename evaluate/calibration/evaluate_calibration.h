// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/error.h"
#include "evaluate/metrics/calibration/score.h"
#include "evaluate/results/progress.h"
#include "evaluate/session/load_session.h"
#include "report/records/calibration_record.h"

namespace plumbline {

/// What `plumbline evaluate calibration` is asked to do.
struct EvaluateCalibrationRequest {
  std::string calibration;  ///< file: ours, Kalibr's, yac's
  LoadRequest load;         ///< of the session
  /// Folders of sessions that the calibration has not seen; read as `load` says, whole. Where the
  /// files say otherwise the score is not marked as held out, and the verdict says so.
  std::vector<std::string> held_out;
  ScoreOptions score;
  Provenance provenance;  ///< version, command, options and date; input and hash are filled in

  /// Throws InputError for values out of range.
  void check() const;
};

/// Reads, detects and scores: a record whose `held` has the scores, the session's first. Fails
/// where the calibration gives the session no score at all; throws InputError for bad input.
Result<CalibrationRecord> evaluateCalibration(const EvaluateCalibrationRequest& request,
                                              const ProgressSink& progress);

/// The same for a person: one line a score.
std::string evaluationSummary(const CalibrationRecord& record);

}  // namespace plumbline
