// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/session.h"
#include "evaluate/compare/parameters.h"
#include "evaluate/metrics/calibration/score.h"
#include "report/records/comparison_record.h"

namespace plumbline {

/// Calibrates the session itself, as `plumbline calibrate` does: with the camera models of the
/// first calibration, the board's shape under `target`, and with the IMU where a calibration and
/// the session have one. Compares every calibration with the result: comparedParameters() of the
/// session's own estimate and all of them, in this order.
///
/// The significance of a calibration that was estimated from the same session says little: the two
/// share their corners. What cannot be calibrated (a model that can only be scored, a stage that
/// fails) is said in SessionEstimate::problem; then `parameters` has what there is.
SessionEstimate sessionEstimate(Session session, const std::vector<Calibration>& calibrations,
                                const ScoreOptions& options, TargetMode target,
                                const ComparisonThresholds& thresholds);

}  // namespace plumbline
