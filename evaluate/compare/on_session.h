// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "evaluate/metrics/calibration/score.h"
#include "report/records/comparison_record.h"

namespace plumbline {

/// Per camera, over the views that both results of the same session used: mean of
///   d_v = mean |e|^2 under `other` - mean |e|^2 under `first`   [px^2]
/// with its standard error and 95 % interval. Pairing takes out what makes a view hard for both;
/// neighbouring views are alike, so the error comes from means of blocks of 10 consecutive views,
/// with as many degrees of freedom as blocks less one; below 5 blocks there is neither. Cameras
/// without two common views are left out.
std::vector<PairedPrediction> pairedPredictions(const CameraStageResult& first,
                                                const CameraStageResult& other,
                                                const std::string& label);

/// The board on which calibrations are scored where nobody says which: the recording's own shape,
/// where its corners, under the lens models that they ask for, say that it is not the stated one
/// (TargetFinding::kBent), else the stated one. Cameras that were estimated under a wrong shape fit
/// corners on that shape best: which of two is nearer to the truth only shows on the true one.
TargetShape boardOf(const Session& session, CameraStageOptions options);

/// Calibrates the session itself, as `plumbline calibrate` does: with the camera models of the
/// first calibration, the board's shape under `target`, and with the IMU where a calibration and
/// the session have one. Compares every calibration with the result: comparedParameters() of the
/// session's own estimate and all of them, in this order.
///
/// The significance of a calibration that was estimated from the same session says little: the two
/// share their corners. What cannot be calibrated (a model that can only be scored, a stage that
/// fails) is said in SessionEstimate::problem; then `parameters` has what there is.
SessionEstimate sessionEstimate(Session session, const std::vector<Calibration>& calibrations,
                                const ScoreOptions& options, TargetMode target);

}  // namespace plumbline
