// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibrator/base/calibration.h"
#include "calibrator/base/results.h"
#include "calibrator/base/session.h"
#include "evaluate/metrics/calibration/score.h"
#include "evaluate/metrics/verdict.h"

namespace plumbline {

/// Whether cameras that were held fixed on a recording (`held`: only poses estimated) explain its
/// corners as well as cameras of the same models do that are estimated from these corners, from the
/// held ones as a start: a caution where they leave 1.05 times the RMSE. An RMSE by itself does not
/// tell: poses absorb most of a focal length that is wrong by 1 %, which leaves a tenth of a pixel.
/// Parameters that noise alone moves make about sqrt(1 + p / n) times, p parameters of n residuals:
/// 1.01 with 1,000. Not judged where nothing could be estimated, none for models that can only be
/// scored.
std::vector<Finding> judgeHeldCameras(const CameraStageResult& held, const Session& session,
                                      const ScoreOptions& options);

}  // namespace plumbline
